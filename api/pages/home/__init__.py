"""The home page: a question and its answer."""
