"""Every extractor on reference features: over noise, size, phase and more, with the bound."""
