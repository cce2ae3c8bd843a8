"""Error budgets: how much each part of the chain adds to the error of each leading pipeline."""
