"""Named selections of what there is to measure: planned, measured, verified, tidied up."""
