"""Feature extractors: one class each; a new one is one new file here, found by discovery."""
