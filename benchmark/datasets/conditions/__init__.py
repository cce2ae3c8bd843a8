"""Conditions that data sets of a family share, one family a module.

`alignment` and `propagation` hold what families share: errors of assembly; light, glass, regimes.
`cone`, `flight`, `full_frames` and `uneven_light` are the fields and the kinds of preset that only
some families need.
"""
