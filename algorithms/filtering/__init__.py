"""State estimation over sequences: a description of state spaces, and filters that read it."""
