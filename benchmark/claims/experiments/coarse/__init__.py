"""Coarse sensors, albedo and filters (C16 to C19, C24 to C29)."""
