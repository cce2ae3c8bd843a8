"""The survey's figures, live: their data, their layout, and SVG drawn on the server."""
