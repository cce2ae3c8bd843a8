"""Physics-informed models: what assembly and electronics do to a sensor, learnt and undone."""
