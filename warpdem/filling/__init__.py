"""Bodies put into place without overlap."""
