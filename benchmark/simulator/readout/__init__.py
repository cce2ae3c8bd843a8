"""From light to numbers: detectors, currents and noise."""
