"""Parts of an answer as JSON, each written once and kept."""
