"""Periodic masks over lines of pixels: where the pattern is, by the phase of all its slits."""
