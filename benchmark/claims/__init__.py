"""The survey's statements about algorithms as experiments with verdicts."""
