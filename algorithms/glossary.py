"""Parameters and attributes that unrelated classes share, described once; `documented` reads them.

Only docstrings here: what explains a parameter does not enter the digest of what it computes.

Parameters
----------
focal_length_mm : float
    Distance from mask or lens to detector, positive; nominal where the model fits it.
unit_mm : float
    Displacement of the spot per unit of the feature, positive: the pixel pitch for spots, half the
    aperture's width for balances.
centre : tuple of two float
    Feature (x, y) of the spot when the Sun is on the boresight; nominal where the model fits it.
face_normals : tuple of K vectors
    Unit normals of the faces in the order of the features, K at least 3, spanning space.
pixel_pitch_mm : float
    Distance between pixels, positive.
line_axes : tuple of {"x", "y"}
    The detector axis along which each line lies, in the order of a profile's columns.
line_pixels : int
    Pixels of a line, at least 1.
light : {"spot", "any"}
    Expected shape of the light. "spot": one whole, compact and symmetric spot; other light gives
    NaN. "any": also streaks, rings and stars, as lenses and slits cause them.
longest_px : float or None
    Longest half axis that the outline of one spot has, px, positive; None if the design does not
    give it. See `algorithms.extractors.frames.mirror.extractor`.
saturation : float or None
    Readings at or above it are saturated; the row is NaN.
window_px : int or None
    Odd side, at least 3, of a square window that starts on the brightest pixel and moves to its
    own centroid until it no longer changes; None sums the whole frame, as published.
accuracy_px : float
    Required accuracy dx of a position, at least 1e-4 px; it determines the number of thresholds.
disc_deg : float
    Full angle of the Sun's disc, in (0, 10).
iterations : int
    Maximum number of steps, at least 1; without convergence the fit fails.
restarts : int
    Number of trainings from different initial weights, 1 to 50; the best on held-out samples is
    kept.
seed : int
    Seed of the initial weights, not negative; the same seed gives the same fit.

Attributes
----------
middle_, half_range_ : ndarray, shape (2,)
    The features' scaling ``u = (feature - middle) / half_range`` onto [-1, 1].
validated_deg_ : float or None
    Cross-validation error of the selected setting.

Raises
------
ValueError
    If a parameter is not as said above; the message names it.
"""
