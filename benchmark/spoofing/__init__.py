"""A laser beside the Sun or instead of it: who believes it, and which tests notice."""
