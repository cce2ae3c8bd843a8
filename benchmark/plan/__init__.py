"""What there is to measure, and what it is made of."""
