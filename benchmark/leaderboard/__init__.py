"""The leaderboard: what the results say, ranked, shown and checked."""
