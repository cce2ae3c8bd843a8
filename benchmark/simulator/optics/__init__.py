"""From the mask to the detector: assembly, glass, lenses, flare and diffraction."""
