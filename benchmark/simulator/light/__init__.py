"""What shines: the Sun, what else reaches the sensor, and rendered light that is kept."""
