"""Terms that models of a calibration may have beside their own: what a sensor's warmth does."""
