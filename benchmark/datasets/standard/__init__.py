"""The standard data sets: a module each, which defines PRESET."""
