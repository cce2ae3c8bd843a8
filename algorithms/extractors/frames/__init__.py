"""Extractors of frames: the position of one spot."""
