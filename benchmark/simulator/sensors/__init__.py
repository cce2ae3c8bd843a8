"""Simulated sensors, one kind a module."""
