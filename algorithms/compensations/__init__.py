"""Compensations: effects of the Sun, the Earth, the optics and the electronics taken out."""
