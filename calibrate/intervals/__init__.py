"""Errors of samples left out, and their scale by place."""
