"""Masks that carry a code: reading it, placing the apertures, one direction of all spots."""
