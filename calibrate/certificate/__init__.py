"""A calibration as a digital calibration certificate (DCC), the metrologists' XML."""
