"""Files written whole or not at all, locked while written, and read strictly."""
