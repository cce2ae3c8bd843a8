"""Multiplex models: masks that carry a code."""
