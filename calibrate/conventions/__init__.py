"""Conventions that a file follows: axes, angles, rows, runs, light, quadrants, faces."""
