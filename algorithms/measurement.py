"""Result of `Extractor.measure`: features, their covariance and flags."""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Dimensions of a batch, by the value of `algorithms.contract.Observation`.
_BATCH_DIMENSIONS = {"frames": 3, "profiles": 2, "currents": 2, "events": 3}
#: Observations whose elements have neighbours that can stand in for them.
_WITH_NEIGHBOURS = frozenset({"frames", "profiles"})

#: Channels that a picture in colour has, as its last dimension.
_COLOURS = 3, 4


class QualityFlag(enum.IntFlag):
    """Why an answer is missing or may be wrong; several at once are joined by ``|``.

    A row of NaN carries its reason; a flag beside a finite answer says what to be careful of.
    """

    NO_SPOT = 1
    """Nothing was found, or nothing the method answers for."""
    SEVERAL_SPOTS = 2
    """More than one light, or a light whose shape is that of two that overlap."""
    CUT = 4
    """The spot reaches the edge of the frame."""
    SATURATED = 8
    """Pixels of the spot are at the converter's largest number."""
    NOT_SYMMETRIC = 16
    """The light has no centre of symmetry."""
    GHOST = 32
    """A second, weaker light is near: a reflection."""
    AMBIGUOUS_PATTERN = 64
    """Another identity of the pattern's spots explains the frame nearly as well."""

    @classmethod
    def _missing_(cls, value: object) -> Any:
        """Take NumPy's integers, as `Measurement.flags` holds them."""
        return super()._missing_(int(value) if isinstance(value, np.integer) else value)


@dataclass(frozen=True)
class Measurement:
    """Features with their covariance and flags.

    What `Extractor.measure` returns; one row, matrix and flag a sample.

    Parameters
    ----------
    features : ndarray, shape (N, F)
        As `extract` gives them; NaN rows where nothing was found.
    covariance : ndarray, shape (N, F, F)
        Of the errors that noise makes, in the features' units squared; NaN where the method states
        none.
    flags : ndarray of int, shape (N,)
        Joined `QualityFlag` members; 0 for none. ``QualityFlag(flags[k])`` names them.

    Raises
    ------
    ValueError
        If the shapes do not agree.

    Examples
    --------
    >>> found = Measurement(np.array([[3.0, 4.0]]), np.eye(2)[None], np.array([8]))
    >>> QualityFlag(found.flags[0]) is QualityFlag.SATURATED
    True
    >>> found.deviations
    array([[1., 1.]])
    """

    features: NDArray[np.float64]
    covariance: NDArray[np.float64]
    flags: NDArray[np.int64]

    def __post_init__(self) -> None:
        n, f = self.features.shape
        if self.covariance.shape != (n, f, f) or self.flags.shape != (n,):
            raise ValueError(
                f"features {self.features.shape} go with covariance ({n}, {f}, {f}) and flags "
                f"({n},); got {self.covariance.shape} and {self.flags.shape}"
            )

    @property
    def deviations(self) -> NDArray[np.float64]:
        """Standard deviation of each feature, (N, F)."""
        diagonal = np.diagonal(self.covariance, axis1=1, axis2=2)
        return np.asarray(np.sqrt(diagonal), dtype=np.float64)


def as_batch(observations: ArrayLike, observation: str) -> Any:
    """Return a batch: a single sample becomes a batch of one, missing pixels those around them.

    A pixel is missing where it is masked, NaN or infinite: in frames and profiles it gets the
    median of its nearest good neighbours, as a bad pixel does. A sample without a pixel is NaN.

    Parameters
    ----------
    observations : array_like
        A batch (N, ...) or one sample (...).
    observation : {"frames", "profiles", "currents", "events"}
        What it is, an `algorithms.contract.Observation`.

    Returns
    -------
    array_like
        The batch; whatever has another number of dimensions comes back for `extract` to refuse.

    Raises
    ------
    ValueError
        If it is a colour picture, which would pass for a batch of frames 3 or 4 px wide.

    Examples
    --------
    >>> as_batch(np.zeros((4, 5)), "frames").shape
    (1, 4, 5)
    >>> as_batch([[1.0, 2.0, np.nan, 4.0, 5.0]], "profiles")
    array([[1., 2., 3., 4., 5.]])
    """
    try:
        array = np.asanyarray(observations)
    except ValueError:  # ragged: `extract` says what it expected
        return observations
    single = array.ndim == _BATCH_DIMENSIONS[observation] - 1 and array.size > 0
    if observation == "frames" and _in_colour(array.shape):
        raise ValueError(
            f"an array of shape {array.shape} is a picture in colour: frames are grey, (H, W) or "
            "(N, H, W); take its luminance, as cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) does"
        )
    whole = array.ndim == _BATCH_DIMENSIONS[observation] and array.size > 0
    if observation in _WITH_NEIGHBOURS and (single or whole):
        return _without_missing(array[None] if single else array)
    return array[None] if single else observations


def _without_missing(batch: NDArray[Any]) -> NDArray[Any]:
    masked = isinstance(batch, np.ma.MaskedArray)
    given = np.ma.getdata(batch)
    missing = np.ma.getmaskarray(batch) if masked else np.zeros(given.shape, dtype=np.bool_)
    if given.dtype.kind == "f":
        missing = missing | ~np.isfinite(given)
    if not missing.any():
        return given
    lost = missing.reshape(len(given), -1).all(axis=1)
    repaired = given.astype(np.float64) if lost.any() else given.copy()
    repaired[lost] = np.nan
    for at in np.flatnonzero(missing.reshape(len(given), -1).any(axis=1) & ~lost):
        repaired[at] = without_bad(repaired[at][None], missing[at], "measure")[0]
    return repaired


def _in_colour(shape: tuple[int, ...]) -> bool:
    return len(shape) == 3 and shape[2] in _COLOURS and min(shape[:2]) > shape[2]


def as_bad(bad: ArrayLike, shape: tuple[int, ...], by: str) -> NDArray[np.bool_]:
    """Check a mask of bad pixels.

    Parameters
    ----------
    bad : array_like of bool, shape `shape`
        True where a pixel is to be left out.
    shape : tuple of int
        That of one sample.
    by : str
        Who reads it, for the message.

    Returns
    -------
    ndarray of bool
        The mask.

    Raises
    ------
    ValueError
        If it is not boolean, has another shape, or leaves no pixel.

    Examples
    --------
    >>> as_bad([True, False], (2,), "bcm")
    array([ True, False])
    """
    mask = np.asarray(bad)
    if mask.dtype != np.bool_:
        raise ValueError(f"bad of {by} must be boolean, True for a bad pixel; got {mask.dtype}")
    if mask.shape != shape:
        raise ValueError(f"bad of {by} must have a sample's shape {shape}; got {mask.shape}")
    if mask.all():
        raise ValueError(f"bad of {by} must leave some pixels; got all of {mask.size}")
    return mask


def without_bad(batch: ArrayLike, bad: ArrayLike, by: str) -> NDArray[Any]:
    """Replace bad pixels by the median of their nearest good neighbours.

    For methods that cannot leave pixels out. The neighbours are the good pixels of the smallest
    square around a bad one (of a profile, the smallest interval) that holds at least three, or all
    there are.

    Parameters
    ----------
    batch : array_like, shape (N, H, W) or (N, W)
        Frames or profiles.
    bad : array_like of bool, shape (H, W) or (W,)
        True where a pixel is bad.
    by : str
        Who reads them, for the message.

    Returns
    -------
    ndarray, shape of `batch`
        A copy, of the same dtype: medians of whole numbers are rounded.

    Raises
    ------
    ValueError
        As `as_bad`.

    Examples
    --------
    >>> without_bad([[1, 2, 99, 4, 5]], [False, False, True, False, False], "bcm")
    array([[1, 2, 3, 4, 5]])
    """
    repaired = np.array(batch)
    mask = as_bad(bad, repaired.shape[1:], by)
    good = np.argwhere(~mask)
    given = repaired.copy()
    for pixel in np.argwhere(mask):
        away = np.abs(good - pixel).max(axis=1)
        reach = np.sort(away)[: min(3, len(away))][-1]
        near = given[(slice(None), *good[away <= reach].T)].astype(np.float64)
        middle = np.median(near, axis=1)
        whole = repaired.dtype.kind in "bui"
        repaired[(slice(None), *pixel)] = np.rint(middle) if whole else middle
    return repaired


def measurement_of(
    extract: Callable[[ArrayLike], NDArray[np.float64]],
    observation: str,
    by: str,
    observations: ArrayLike,
    bad: ArrayLike | None = None,
) -> Measurement:
    """Measure with an extractor that states no covariance: what `Extractor.measure` does.

    Parameters
    ----------
    extract : callable
        Features (N, F) of a batch.
    observation : {"frames", "profiles", "currents", "events"}
        What it reads.
    by : str
        Whose it is, for messages.
    observations : array_like
        A batch, or one sample of it.
    bad : array_like of bool, optional
        Pixels to replace by their neighbours' median, shape of one frame or profile.

    Returns
    -------
    Measurement
        Covariance NaN; NO_SPOT where features are NaN.

    Raises
    ------
    ValueError
        As `extract`; for a mask of another shape, or of currents or events.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> measurement_of(BasicCentroid().extract, "frames", "bcm", np.eye(3)).features
    array([[1., 1.]])
    """
    batch = as_batch(observations, observation)
    if bad is not None:
        if observation not in _WITH_NEIGHBOURS:
            raise ValueError(
                f"{by} reads {observation}, which have no neighbouring pixels to "
                "stand in for bad ones: leave bad=None; got a mask"
            )
        # Wrong batches get the message of `extract`; there is nothing to repair in them.
        ready = np.ndim(batch) == _BATCH_DIMENSIONS[observation]
        batch = without_bad(batch, bad, by) if ready else batch
    features = extract(batch)
    n, f = features.shape
    missing = np.isnan(features).any(axis=1)
    flags = np.where(missing, int(QualityFlag.NO_SPOT), 0).astype(np.int64)
    return Measurement(features, np.full((n, f, f), np.nan), flags)
