"""Fitted functions, tables, networks and coded masks (C01 to C08, C33 to C35)."""
