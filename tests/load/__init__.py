"""Campaigns against a running service: `python -m tests.load`, in its own time (`make load`)."""
