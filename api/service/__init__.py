"""What a question becomes: documents of every resource, for HTTP, pages and command line."""
