"""A calibration as code that flies: tables of directions, C99 and Python."""
