"""Sensors in orbit: where they fly, how they turn, what changes with time."""
