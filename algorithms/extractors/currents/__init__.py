"""Extractors of currents and voltages of a few photodiodes."""
