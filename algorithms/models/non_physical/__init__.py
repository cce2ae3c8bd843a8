"""Non-physical models: curves fitted to calibration data."""
