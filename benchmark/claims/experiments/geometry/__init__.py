"""Geometric models and their compensations (C09 to C15, C20 to C23, C30 to C32)."""
