"""Every experiment beside the scores: a module each, found by discovery."""
