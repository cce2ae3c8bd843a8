"""Light that is not the Sun's, and shadows in the light that is."""
