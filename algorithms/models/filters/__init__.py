"""Models that carry the Sun from sample to sample: Kalman filters calibrated on the ground."""
