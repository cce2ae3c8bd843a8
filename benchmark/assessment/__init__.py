"""The survey's scores of each method beside measured ones."""
