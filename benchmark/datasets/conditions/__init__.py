"""Conditions that data sets of a family share, one family a module."""
