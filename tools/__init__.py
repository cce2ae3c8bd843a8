"""Programs for development: what measures and checks the project beside its tests."""
