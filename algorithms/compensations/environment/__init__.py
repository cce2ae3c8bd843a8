"""What the Sun's disc and the temperature do to a sensor in space."""
