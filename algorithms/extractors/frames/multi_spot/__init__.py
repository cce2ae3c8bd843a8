"""Extractors of frames: the position of a whole pattern of spots."""
