"""State estimation over sequences: one description of a state space, and the filters that read it."""
