"""Extractors of spikes of event sensors."""
