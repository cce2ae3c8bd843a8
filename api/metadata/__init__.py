"""Metadata for machines: Croissant, schema.org, Signposting, CodeMeta."""
