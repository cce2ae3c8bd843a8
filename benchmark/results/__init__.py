"""Results as plain files that live in git: scores, sweeps, pins of data, digests of code."""
