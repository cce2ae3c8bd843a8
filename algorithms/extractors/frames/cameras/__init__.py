"""Extractors of frames: the Sun as cameras with a lens show it."""
