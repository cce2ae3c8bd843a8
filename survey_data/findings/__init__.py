"""The survey's narrative findings, checked against the tables."""
