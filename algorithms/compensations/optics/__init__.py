"""What glass does to light on its way to the detector."""
