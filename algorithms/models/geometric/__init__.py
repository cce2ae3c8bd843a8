"""Geometric models: the sensor's drawing, as it is or with fitted parameters."""
