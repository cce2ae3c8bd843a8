"""Masks of the Sun's image, by a small network and by thresholds, in frames with faults."""
