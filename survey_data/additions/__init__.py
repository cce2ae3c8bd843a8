"""Studies the survey does not map: read from a template or a bibliography, added, confirmed, removed."""
