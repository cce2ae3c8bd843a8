"""Extractors of lines of pixels behind slits, and the same methods on frames."""
