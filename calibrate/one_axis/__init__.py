"""Sensors of one axis: the angle in the plane that the light was swept in."""
