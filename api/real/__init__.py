"""Real readings of others, fetched on request from where they are public; none is bundled."""
