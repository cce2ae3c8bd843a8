"""Reference features whose light is known in closed form, with their bounds."""
