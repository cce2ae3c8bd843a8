"""Extractors of frames, events and balances (C36 to C50)."""
