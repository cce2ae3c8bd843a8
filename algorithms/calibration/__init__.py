"""What calibrated models share: what they were calibrated on, how well, and how they are kept."""
