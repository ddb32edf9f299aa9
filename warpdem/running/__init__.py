"""A run on disk: folder, clock, progress, interrupts."""
