"""Charts as SVG in the page: they take its colours, print with it and need no script."""
