"""Whether the tables keep their own rules."""
