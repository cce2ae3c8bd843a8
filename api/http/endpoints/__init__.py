"""The endpoints under /v1, one module a subject; each gives its endpoints from the facts."""
