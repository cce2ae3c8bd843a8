"""Outward: the command line, the HTTP service, the page, the deposit and generated docs.

Importing this package loads nothing: every part is imported where it is needed.
"""
