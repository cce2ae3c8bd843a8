"""Measuring: plans carried out in parallel, resumable, the same numbers wherever they run."""
