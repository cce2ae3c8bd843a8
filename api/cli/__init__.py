"""The command line, `sunatlas`."""
