"""What is raised where a file of readings cannot be read."""

from __future__ import annotations


class TableError(ValueError):
    """A file that is no table of numbers: what was expected, what came, in which row and column."""
