"""Compiled loops. Importing one of these modules loads Numba: do it at first use."""
