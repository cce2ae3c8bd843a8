"""Display names of extractors, compensations and models: what a page shows beside the identifier.

A variant of ours under the survey's identifier says so. A method without an entry is shown under
its identifier, so a new algorithm needs no entry.
"""

from __future__ import annotations

from collections.abc import Mapping

#: Added to the name of a method whose default differs from the form that the survey prints.
VARIANT = " (our variant)"

DISPLAY_NAMES: Mapping[str, str] = {
    # extractors of frames
    "bcm": "Centroid",
    "bctm": "Thresholded centroid" + VARIANT,
    "bscm": "Black sun centroid",
    "dbcm": "Double balance centroid" + VARIANT,
    "energy-filter": "Energy-filtered centroid",
    "feic": "Image correlation of many spots" + VARIANT,
    "fmms": "Mean shift of many spots",
    "gaussian-fit": "Gaussian fit",
    "hough-circle": "Circle Hough transform",
    "hough-lines": "Line Hough transform of the blooming line",
    "ifm": "Filtered centroid",
    "line-windows": "Windowed lines of an L",
    "linear-phase-frame": "Linear phase of a spot",
    "mcam": "Mean of many centroids",
    "mirror": "Mirror registration",
    "mt-acm": "Multiple-threshold midpoint",
    "pd-frame": "Brightest pixel",
    "pm": "Maximum of column and row sums",
    "ppe-frame": "Peak fit of column and row sums",
    "spot-list": "List of thresholded centroids",
    "tm": "Template matching" + VARIANT,
    "weighted-spots": "Weighted mean of many spots",
    "windowed-array": "Windowed centroids of an array of spots",
    "windowed-list": "List of windowed centroids",
    # extractors of profiles
    "bcm-profile": "Centroid of a profile",
    "bctm-profile": "Thresholded centroid of a profile",
    "direct-profile": "Calibrated profile",
    "eigen-analysis": "Eigen-analysis of the cross-spectrum",
    "linear-phase": "Linear phase of a profile",
    "mt-acm-profile": "Multiple-threshold midpoint of a profile",
    "pd": "Peak detection",
    "ppe": "Joint fit of peaks",
    "slit-image": "Diffraction model fit of slit images",
    "threshold-profile": "Thresholded profile",
    # extractors of currents and events
    "dial-tracks": "Calibrated signals of code dials",
    "direct": "Calibrated photodiode signals",
    "escm": "Centroid of events",
    "escm-wta": "First events (winner takes all)",
    "voltage-balance": "Voltage balance",
    # compensations
    "angular-loss": "Angular loss compensation",
    "computed-earth": "Computed albedo compensation",
    "computed-earth-balance": "Computed albedo compensation of quadrants",
    "estimated-earth": "Estimated albedo compensation",
    "maximum-currents": "Maximum current compensation of albedo",
    "optical": "Refraction compensation",
    "pinhole-shadow": "Shadow compensation of a round hole",
    "shadow": "Shadow compensation",
    "slit-shadow": "Shadow compensation of a slit",
    "solar-disc": "Solar disc compensation",
    "sun-and-albedo-inputs": "Separation of Sun and albedo",
    "sun-and-earth": "Albedo model compensation",
    "temperature": "Temperature compensation",
    # models
    "adaptive-kalman": "Adaptive Kalman filter",
    "ann": "Neural network with one hidden layer",
    "assembled-faces": "Assembly calibration of faces",
    "assembly-drift": "Kalman filter of the assembly",
    "basic": "Brighter face of each pair",
    "camera": "Camera model",
    "coded-correlation": "Coded mask by correlation",
    "coded-places": "Coded mask with learned places",
    "coded-spacing": "Coded mask by spacings",
    "consider-kalman": "Consider Kalman filter",
    "cubature-kalman": "Cubature Kalman filter",
    "dnn": "Deep network of signals",
    "dnn-surface": "Cubic surface and deep network",
    "extended-kalman": "Extended Kalman filter",
    "fourier-balance": "Fourier series of a balance",
    "fourier-phase": "Fourier series of a code dial",
    "homography": "Homography",
    "linear": "Linear fit",
    "lsq": "Pinhole with five parameters",
    "lut": "Look-up table",
    "lut-polynomial": "Look-up table of polynomials",
    "multi-slit": "Multi-slit model",
    "multiple-models": "Multiple-model Kalman filter",
    "n-slit": "N-slit model",
    "panoramic": "Weighted least squares of cells",
    "panoramic-temperature": "Weighted least squares of cells with temperature",
    "periodic": "Code dial with periodic error",
    "pinhole": "Pinhole with all assembly errors",
    "polynomial-1d": "Polynomial of one axis",
    "polynomial-2d": "Polynomial surface",
    "polynomial-signals": "Polynomial of signals",
    "pyramidal": "Pyramid fusion",
    "pyramidal-constant": "Pyramid fusion without constant light",
    "qpd": "Quadrant photodiode with gap",
    "reticle": "Reticle model",
    "robust-kalman": "Robust Kalman filter",
    "sigmoid": "Sigmoid",
    "slit": "Slit model",
    "slit-pairs": "Slit model of photodiode pairs",
    "solar-panel": "Sum of panel normals",
    "spot-array": "Array of apertures with learned places",
    "spm": "Standard projection",
    "sure-faces": "Assembly calibration of faces without doubtful answers",
    "trig": "Trigonometric fit",
    "trig-averaged": "Averaged trigonometric fit",
    "unscented-kalman": "Unscented Kalman filter",
    "v-slit": "V-slit model",
    "vernier": "Vernier model",
}


def display_name(name: str) -> str:
    """Return the display name of a method, chain or pipeline.

    Parameters
    ----------
    name : str
        Identifier, such as ``bctm``, or several with `` + `` between.

    Returns
    -------
    str
        Such as ``Thresholded centroid (our variant) + Pinhole with all assembly errors``.

    Examples
    --------
    >>> display_name("optical + lut")
    'Refraction compensation + Look-up table'
    """
    return " + ".join(DISPLAY_NAMES.get(part, part) for part in name.split(" + "))
