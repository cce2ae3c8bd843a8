"""What a photodiode makes of the light that reaches it."""
