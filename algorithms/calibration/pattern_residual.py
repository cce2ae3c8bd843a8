"""Whether a reading shows one Sun where the answer says: its residual against calibration readings.

A second light, a laser say, pulls the answer to somewhere between the two, where neither is. The
pattern that one Sun casts from there is known from the calibration, and is not what was read.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats, NotFittedError, UnusableDataError

#: Calibration readings around an answer: from which elements are predicted, and images.
_AROUND, _IMAGES = 12, 6
#: Rounds of weighing squared residuals by their expected variance, and how many of them at most.
_ROUNDS, _SQUARES = 5, 1_000_000
#: Least share of the weight of an answer's neighbours that must see a pixel.
_SEEN = 0.3


class Residual(NamedTuple):
    """What `PatternResidual.measure` gives, each (N,); NaN where there is no answer.

    `pattern` is the chi-square of a reading against the pattern predicted, over its degrees of
    freedom, about 1 for one Sun; `brightness` that pattern's, over that of the calibration's lamp.
    """

    pattern: Floats
    brightness: Floats


@dataclass
class PatternResidual:
    """Residual of readings against those that a calibration had around the answered direction.

    Elements are predicted by a surface of second order through the calibration's nearest readings,
    images moved to where the answer puts them. Brightness, a shift and, of images, even light are
    fitted; what is left is weighed by what is left of calibration readings that were predicted from
    the others, as a function of light and its slope.

    Parameters
    ----------
    focal_px : float, optional
        Of images: pixels that they move a unit of the Sun's tangents. None for currents.

    Examples
    --------
    A cube's faces answer by the cosine; of two lights its residual is large.

    >>> draw = np.random.default_rng(1)
    >>> sun = np.column_stack([draw.uniform(-0.4, 0.4, (200, 2)), np.ones(200)])
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> faces = np.array([[1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1]]) / np.sqrt(2)
    >>> test = PatternResidual().fit(sun @ faces.T + 1e-3 * draw.normal(size=(200, 4)), sun)
    >>> one = sun[:1] @ faces.T
    >>> two = one + np.maximum([[0.5, 0.0, 0.1]] @ faces.T, 0.0)
    >>> (test.measure(np.vstack([one, two]), sun[[0, 0]]).pattern > 15.0).tolist()
    [False, True]
    """

    focal_px: float | None = None
    readings_: Floats = field(init=False, repr=False)
    sun_: Floats = field(init=False, repr=False)
    origin_px_: Floats = field(init=False, repr=False)
    amplitude_: Floats = field(init=False, repr=False)
    curves_: Floats = field(init=False, repr=False)
    variance_: Floats = field(init=False, repr=False)

    def fit(self, readings: ArrayLike, sun: ArrayLike, origin_px: ArrayLike | None = None) -> Self:
        """Learn patterns and what varies about them from readings of known Suns.

        Parameters
        ----------
        readings : array_like, shape (n, K) or (n, H, W)
            Currents or images, corrected for dark signal and gain.
        sun : array_like, shape (n, 3)
            Unit vectors.
        origin_px : array_like, shape (n, 2), optional
            Detector coordinates (x, y) of each image's first pixel.

        Returns
        -------
        PatternResidual
            Itself.

        Raises
        ------
        ValueError
            If shapes do not go together.
        UnusableDataError
            If there are fewer readings than a prediction takes.
        """
        values, directions, origin = self._checked(readings, sun, origin_px)
        kept = np.isfinite(values.reshape(len(values), -1)).all(axis=1)
        kept &= np.isfinite(directions).all(axis=1)
        if kept.sum() <= _AROUND:
            raise UnusableDataError(
                f"a pattern's residual takes more than {_AROUND} readings; got {kept.sum()}"
            )
        self.sun_, self.origin_px_ = directions[kept], origin[kept]
        flat = values[kept].reshape(int(kept.sum()), -1)
        self.amplitude_ = (flat**2).sum(axis=1) / np.maximum(flat.sum(axis=1), 1e-300)
        self.readings_ = values[kept] / self.amplitude_.reshape(-1, *(1,) * (values.ndim - 1))
        if self.focal_px is not None:
            from scipy.ndimage import spline_filter  # noqa: PLC0415 - SciPy on demand

            self.curves_ = np.stack([spline_filter(image) for image in self.readings_])
        self.variance_ = self._left_over()
        return self

    def measure(
        self, readings: ArrayLike, answers: ArrayLike, origin_px: ArrayLike | None = None
    ) -> Residual:
        """Hold readings to the patterns of their answers.

        Parameters
        ----------
        readings : array_like, shape (N, K) or (N, H, W)
            As `fit` had them.
        answers : array_like, shape (N, 3)
            Unit vectors; NaN rows for none.
        origin_px : array_like, shape (N, 2), optional
            As of `fit`.

        Returns
        -------
        Residual
            Of every reading.

        Raises
        ------
        ValueError
            If shapes do not go together.
        NotFittedError
            Before `fit`.
        """
        if not hasattr(self, "variance_"):
            raise NotFittedError("PatternResidual is not fitted yet; call fit first")
        values, directions, origin = self._checked(readings, answers, origin_px)
        if values.shape[1:] != self.readings_.shape[1:]:
            raise ValueError(
                f"readings must be as those of the calibration, (N, "
                f"{str(self.readings_.shape[1:])[1:]}; got {values.shape}"
            )
        pattern, brightness = np.full((2, len(values)), np.nan)
        answered = np.isfinite(directions).all(axis=1)
        answered &= np.isfinite(values.reshape(len(values), -1)).all(axis=1)
        for n in np.flatnonzero(answered):
            seen, basis, amplitude, noise = self._predicted(directions[n], origin[n])
            basis *= amplitude
            spread = noise * (_terms(basis) @ self.variance_)
            left, share = _unexplained(values[n].ravel()[seen], basis, spread)
            pattern[n] = (left**2 / spread).sum() / max(len(left) - basis.shape[1], 1)
            brightness[n] = share
        return Residual(pattern, brightness)

    def _checked(
        self, readings: ArrayLike, sun: ArrayLike, origin_px: ArrayLike | None
    ) -> tuple[Floats, Floats, Floats]:
        values = np.asarray(readings, dtype=np.float64)
        directions = np.asarray(sun, dtype=np.float64)
        dimensions = 2 if self.focal_px is None else 3
        if values.ndim != dimensions or directions.shape != (len(values), 3):
            raise ValueError(
                f"expected readings of {dimensions} dimensions and as many directions (N, 3); got "
                f"{values.shape} and {directions.shape}"
            )
        origin = np.zeros((len(values), 2)) if origin_px is None else np.asarray(origin_px, float)
        if origin.shape != (len(values), 2):
            raise ValueError(f"origin_px must be ({len(values)}, 2); got {origin.shape}")
        return values, directions, origin

    def _predicted(
        self, answer: Floats, origin: Floats, without: int | None = None
    ) -> tuple[NDArray[np.bool_], Floats, float, float]:
        """Return which elements are predicted (K,), columns that explain them, amplitude and noise.

        The first column is the pattern, the next two its changes with the direction; images have
        even light, too. The noise is the variance of a reading less its prediction, over its own.
        """
        cosine = self.sun_ @ answer
        if without is not None:
            cosine[without] = -2.0
        near = np.argsort(-cosine)[:_AROUND]
        surface = _surface(self.sun_[near], answer)
        amplitude = float(surface[0] @ self.amplitude_[near])
        amplitude = max(amplitude, 1e-3 * float(self.amplitude_[near].max()))
        noise = 1.0 + float((surface[0] ** 2).sum())
        if self.focal_px is None:
            basis = (surface[:3] @ self.readings_[near]).T
            return np.ones(len(basis), dtype=np.bool_), basis, amplitude, noise
        surfaced = total = weights = np.zeros(self.readings_.shape[1:])
        shares = 1.0 / (1e-6 + 1.0 - cosine[near])
        shares[_IMAGES:] = 0.0
        for k, share, weight in zip(near, shares / shares.sum(), surface[0], strict=True):
            moved = self.focal_px * (_tangents(answer) - _tangents(self.sun_[k]))
            moved += self.origin_px_[k] - origin
            image, there = _moved(self.curves_[k], moved)
            surfaced = surfaced + np.where(there, weight * image, np.nan)
            total = total + share * np.where(there, image, 0.0)
            weights = weights + share * there
        seen = weights > _SEEN
        pattern = np.where(seen, total / np.where(seen, weights, 1.0), np.nan)
        # at a window's edge, which not all of them see, the plain mean has to do
        pattern = np.where(np.isfinite(surfaced), surfaced, pattern)
        rows, columns = np.gradient(pattern)
        seen &= np.isfinite(rows) & np.isfinite(columns)
        parts = (pattern[seen], columns[seen], rows[seen], np.ones(int(seen.sum())))
        return seen.ravel(), np.column_stack(parts), amplitude, noise

    def _left_over(self) -> Floats:
        """Coefficients of the variance, of readings predicted from the others."""
        terms, squares = [], []
        every = max(1, self.readings_.size // _SQUARES)
        for n, reading in enumerate(self.readings_):
            seen, basis, _, noise = self._predicted(self.sun_[n], self.origin_px_[n], without=n)
            basis *= self.amplitude_[n]
            light = reading.ravel()[seen] * self.amplitude_[n]
            left, _ = _unexplained(light, basis, np.ones(len(basis)))
            # what the fit took away of the squares is put back, the prediction's noise taken off
            lost = len(left) / max(len(left) - basis.shape[1], 1) / noise
            terms.append(_terms(basis)[n % every :: every])
            squares.append(lost * left[n % every :: every] ** 2)
        return _variance(np.concatenate(terms), np.concatenate(squares))


def tail_threshold(clean: ArrayLike, false_alarms: float, share: float = 0.05) -> float:
    """Return what clean statistics exceed with a probability, extrapolated where it is small.

    Their tail is taken as generalised Pareto, by probability-weighted moments (Hosking and Wallis,
    Technometrics 29, 1987).

    Parameters
    ----------
    clean : array_like, shape (n,)
        Statistics of readings without a fault; those that are not finite are left out.
    false_alarms : float
        Probability, below `share`, or the quantile itself is returned.
    share : float
        Of the statistics that make the tail.

    Returns
    -------
    float
        The threshold.

    Raises
    ------
    ValueError
        If fewer than 10 statistics make the tail, or a probability is not within (0, 1).

    Examples
    --------
    >>> round(tail_threshold(np.random.default_rng(2).exponential(size=10_000), 1e-4), 1)
    8.5
    """
    values = np.sort(np.asarray(clean, dtype=np.float64))
    values = values[np.isfinite(values)]
    if not (0 < false_alarms < 1 and 0 < share < 1):
        raise ValueError(f"probabilities must be in (0, 1); got {false_alarms} and {share}")
    if false_alarms >= share:
        return float(np.quantile(values, 1.0 - false_alarms))
    count = int(share * len(values))
    if count < 10:
        raise ValueError(f"a tail takes 10 statistics at least; got {count} of {len(values)}")
    least, excess = values[-count - 1], values[-count:] - values[-count - 1]
    mean = float(excess.mean())
    beyond = 1.0 - (np.arange(1, count + 1) - 0.35) / count
    moment = float((beyond * excess).mean())
    shape = 2.0 - mean / (mean - 2.0 * moment)
    scale = 2.0 * mean * moment / (mean - 2.0 * moment)
    if abs(shape) < 1e-9:
        return float(least + scale * np.log(share / false_alarms))
    return float(least + scale / shape * ((share / false_alarms) ** shape - 1.0))


def _tangents(sun: Floats) -> Floats:
    return np.asarray(sun[:2] / max(float(sun[2]), 1e-3))


def _moved(curve: Floats, way: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return an image, of cubic B-spline coefficients, moved by (x, y), and where it still is."""
    there = np.ones(curve.shape, dtype=np.bool_)
    for axis, step in ((0, way[1]), (1, way[0])):
        size = curve.shape[axis]
        place = np.arange(size) - step
        first = np.floor(place).astype(np.int64)
        f = float(place[0] - first[0])
        taps = (1 - f) ** 3, 4 + 3 * f**3 - 6 * f**2, 1 + 3 * f * (1 + f - f**2), f**3
        curve = sum(
            tap / 6.0 * np.take(curve, np.clip(first + k - 1, 0, size - 1), axis)
            for k, tap in enumerate(taps)
        )
        kept = (place >= 0) & (place <= size - 1)
        there &= kept[:, None] if axis == 0 else kept
    return curve, there


def _surface(sun: Floats, answer: Floats) -> Floats:
    """(6, k) weights of values at k Suns: value and derivatives of their surface at the answer."""
    reference = np.eye(3)[int(np.argmin(np.abs(answer)))]
    first = np.cross(reference, answer)
    first /= np.linalg.norm(first)
    ahead = np.maximum(sun @ answer, 1e-3)
    u, v = sun @ first / ahead, sun @ np.cross(answer, first) / ahead
    reach = 1.1 * np.hypot(u, v).max()
    weight = np.sqrt((1.0 - (np.hypot(u, v) / reach) ** 3) ** 3)
    columns = np.column_stack([np.ones(len(u)), u, v, u * u, u * v, v * v])
    return np.asarray(np.linalg.pinv(columns * weight[:, None]) * weight)


def _terms(basis: Floats) -> Floats:
    """(K, 4) of which the variance is made: even, light, its square, its slope's square."""
    light = np.maximum(basis[:, 0], 0.0)
    slope = (basis[:, 1:3] ** 2).sum(axis=1) if basis.shape[1] > 3 else np.zeros(len(basis))
    return np.column_stack([np.ones(len(light)), light, light**2, slope])


def _unexplained(reading: Floats, basis: Floats, spread: Floats) -> tuple[Floats, float]:
    """Return what columns leave of a reading, weighed by its variance, and the first's share."""
    weighed = basis / spread[:, None]
    shares = np.linalg.lstsq(weighed.T @ basis, weighed.T @ reading, rcond=1e-10)[0]
    return reading - basis @ shares, float(shares[0])


def _variance(terms: Floats, squares: Floats) -> Floats:
    """(4,) coefficients, none negative, that squares have as their mean."""
    from scipy.optimize import nnls  # noqa: PLC0415 - SciPy on demand

    scale = np.maximum(terms.max(axis=0), 1e-300)
    found = np.array([float(squares.mean()), 0.0, 0.0, 0.0])
    floor = 1e-3 * float(squares.mean())
    for _ in range(_ROUNDS):
        weight = 1.0 / np.maximum(terms / scale @ found, floor)[:, None]
        weighed = weight * terms / scale
        root = np.linalg.cholesky(
            weighed.T @ weighed + 1e-9 * np.diag((weighed**2).sum(axis=0) + 1e-30)
        )
        found = nnls(root.T, np.linalg.solve(root, weighed.T @ (weight[:, 0] * squares)))[0]
    found[0] = max(found[0], floor)
    return np.asarray(found / scale)
