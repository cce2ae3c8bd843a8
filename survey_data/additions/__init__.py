"""Studies the survey does not map: read from a file, added, confirmed, removed."""
