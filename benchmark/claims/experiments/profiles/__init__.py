"""Extractors of profiles (C51 to C55)."""
