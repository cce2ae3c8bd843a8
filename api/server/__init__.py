"""What serves the service: an application a process, bounded connections."""
