"""Full-text search over all that the atlas tells: `index.Index` of `entries.entries`."""
