"""What HTTP and pages share: requests read, answers written, in the media type asked for."""
