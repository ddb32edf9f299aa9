"""Breakable bonds on the host: where they are made, and what hangs together. Pure NumPy."""
