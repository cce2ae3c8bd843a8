"""Campaigns against a running service: `python -m tools.load`, in its own time (`make load`)."""
