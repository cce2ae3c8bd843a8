"""The survey's future directions (tab:finalsummary), each with a rule and what came of it."""
