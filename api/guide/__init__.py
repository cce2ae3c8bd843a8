"""The guide: docs/ as a site that needs no network, and what keeps its words and blocks true."""
