"""Masks compared at equal height, detector and field: what is left is the mask's own."""
