"""What readers read, as sentences: a linter of its words, and a drawing of samples."""
