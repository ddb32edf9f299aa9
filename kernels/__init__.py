"""Device code: the physics as Warp kernels; the theory is in README.md beside this file."""
