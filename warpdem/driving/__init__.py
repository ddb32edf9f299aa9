"""Motion of the driven bodies as functions of time: NumPy, no Warp."""
