"""The scene file: its format, its reading, its messages."""
