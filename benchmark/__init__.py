"""Measurements: simulator, standard datasets, bounds, runner, results and leaderboard."""
