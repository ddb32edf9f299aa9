"""Non-smooth rockfall: from a rock on a terrain to a hazard map."""
