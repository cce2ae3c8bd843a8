"""The bundle for an archive."""
