"""Causes of bad rows and of wrong conventions, tested before any model is fitted."""
