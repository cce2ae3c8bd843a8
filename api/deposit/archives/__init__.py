"""Archives that take the bundle: Zenodo by either of its two interfaces."""
