"""Parameters and attributes that unrelated classes share, described once; `documented` reads them.

Only docstrings here: what explains a parameter does not enter the digest of what it computes.

Parameters
----------
focal_length_mm : float
    Distance from mask or lens to detector, positive; nominal where the model fits it.
unit_mm : float
    Displacement of the spot for one unit of feature, positive: the pixel pitch for spots, half
    the aperture's width for balances.
centre : tuple of two float
    Feature (x, y) of the spot when the Sun is on the boresight; nominal where the model fits it.
face_normals : tuple of K vectors
    Unit normals of the faces in the order of the features, K at least 3, spanning space.
pixel_pitch_mm : float
    Distance of two pixels, positive.
line_axes : tuple of {"x", "y"}
    The detector axis along which each line lies, in the order of a profile's columns.
line_pixels : int
    Pixels of a line, at least 1.
light : {"spot", "any"}
    What the light looks like: one whole, compact and symmetric spot, anything else being no
    answer; or streaks, rings and stars too, as lenses and slits make them.
longest_px : float or None
    Longest half axis that the outline of one spot has, px, positive; None where no design tells.
    See `algorithms.extractors.frames.mirror.extractor`.
saturation : float or None
    A reading that reaches it says only "at least": the row is NaN.
window_px : int or None
    Odd side, at least 3, of a square window that starts on the brightest pixel and is moved onto
    its own centroid until it stays; None sums the whole frame, as published.
accuracy_px : float
    Wanted accuracy dx of a position, at least 1e-4 px: sets the number of thresholds.
disc_deg : float
    Full angle of the Sun's disc, in (0, 10).
iterations : int
    Steps, at least 1, after which the fit is given up.
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
    Error on samples left out, where they chose a setting.

Raises
------
ValueError
    If a parameter is not as said above; the message names it.
"""
