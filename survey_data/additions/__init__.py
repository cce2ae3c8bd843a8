"""Studies after the survey: read from a template or a bibliography, added, confirmed, removed."""
