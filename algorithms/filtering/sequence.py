"""`SunFilter`: a model that reads samples in the order of time and carries the Sun between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.angles import separation_deg
from algorithms.calibration.calibrated import WORST_RESIDUAL
from algorithms.calibration.quality import FitQuality, data_digest
from algorithms.context import Context, as_context, complete
from algorithms.contract import FeatureKind, Floats, Model, SensorGeometry, UnusableDataError
from algorithms.filtering.drift import GAINS, HEAD_SHIFTS, LEVEL, MOTION, Drift, Gyroscope
from algorithms.filtering.reading_noise import estimate_noise
from algorithms.filtering.shared_results import compute_once
from algorithms.filtering.track import Track
from algorithms.inputs import as_calibration_rows, as_features, require_fitted, require_samples
from algorithms.models.geometric.detector_faces import Normals, require_normals
from algorithms.parameters import require_positive

if TYPE_CHECKING:
    from algorithms.filtering.filters import Belief, Filter
    from algorithms.filtering.readings import FaceReadings, SpotReadings
    from algorithms.filtering.sun_space import SunSpace

CONTEXT = ("time_s", "rate_deg_s", "eclipse", "nadir", "temperature_K")
"""Columns of the context that every filter reads."""

FEWEST = 60
"""Calibration samples below which nothing is learnt."""

#: Steps, in units of the calibration's, from which on a series is broken off.
_LONGEST = 1.5
#: Readings after which a series is answered: one alone is the static calibration's.
_FEWEST_READ = 2
_LEVEL = Drift(place=LEVEL, deviation=0.05, walk=5e-4)
_HOUR_S, _YEAR_S = 3600.0, 365.25 * 86_400.0
#: Steps of correlation up to which residuals count as white.
_WHITE = 2.0
#: White noise that is taken for none, over the residuals' variance.
_QUIET = 1e-6
_ROOT_HOUR = _HOUR_S**0.5
#: Of what has not aged: a covariance must have a root.
_LEAST_AGED = 1e-9


@dataclass
class SunFilter(Model):
    """Base of the filters: learns how the sensor reads a Sun, then follows it from row to row.

    Rows are taken in the order given. Where time does not go on by a step of the calibration's, a
    new series begins and what was known is forgotten. A row is read where it has features and
    light; any other is answered NaN, and the filter goes on by dead reckoning beneath it.

    A subclass writes `about`, and `rule` unless the extended filter's serves it.

    Parameters
    ----------
    face_normals : tuple of K vectors
        Nominal unit normals of faces in the order of the features; none for spots and balances.
    angle_walk_deg_sqrt_h : float
        Angle random walk of the gyroscope, positive.
    bias_deg_h : float
        Standard deviation of the gyroscope's bias at switch-on, positive.
    bias_walk_deg_h_sqrt_h : float
        Standard deviation of the change of the bias in an hour, positive.
    reference_deg : float
        Standard deviation, about each axis, of a constant rotation of the reference of the
        calibration, positive.
    gain_ageing_per_year, shift_ageing_per_year : float
        Standard deviation of the change in a year, positive: of a face's gain relative to the
        others, and of a spot's offsets over the focal length.
    worst_deg : float
        Largest standard deviation of an answered direction, positive; above it the answer is NaN.

    Attributes
    ----------
    readings_ : FaceReadings or SpotReadings
        How the sensor reads a direction.
    noise_ : ndarray, shape (m,)
        Variance of each reading.
    steps_ : ndarray, shape (m,)
        Steps over which its errors are correlated: so many readings tell as much as one would of
        errors that are white.
    calibrated_s_ : float
        Mean time of the calibration.
    starts_ : ndarray, shape (G, 3)
        Directions that the calibration saw.
    step_s_ : float
        Between its samples.
    quality_ : FitQuality
        Of the filter on its own calibration.

    Notes
    -----
    State: the Sun's direction in the body frame, the gyroscope's bias and, before faces, the
    light's strength; ``s' = exp(-[(w - b) dt]) s``, ``z = h(s) + v`` with h as the calibration
    found it, warmth and the Earth's light by nadir included. The rotation of the calibration's
    reference and the ageing are considered, but not estimated.

    Shapes: signals (N, K), or spots or balances (N, 2), in the order of time, with the context's
    columns, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, in eclipse and in the dark, at the first reading of a
    series, and where the 1-sigma is beyond `worst_deg`. A gap in time ends a series. fit raises
    UnusableDataError for fewer than 60 samples in sunlight, or where these do not determine how the
    sensor reads a Sun.

    Cost: 40 us per step on the development machine.
    """

    face_normals: Normals = ()
    angle_walk_deg_sqrt_h: float = 0.15
    bias_deg_h: float = 10.0
    bias_walk_deg_h_sqrt_h: float = 0.5
    reference_deg: float = 0.02
    gain_ageing_per_year: float = 0.01
    shift_ageing_per_year: float = 7.5e-4
    worst_deg: float = 10.0

    readings_: FaceReadings | SpotReadings = field(init=False, repr=False, compare=False)
    noise_: Floats = field(init=False, repr=False, compare=False)
    steps_: Floats = field(init=False, repr=False, compare=False)
    calibrated_s_: float = field(init=False, repr=False, compare=False)
    starts_: Floats = field(init=False, repr=False, compare=False)
    step_s_: float = field(init=False, repr=False, compare=False)
    quality_: FitQuality = field(init=False, repr=False, compare=False)

    #: Rows that a model of single samples would answer, a filter does not answer alone.
    sequential: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.face_normals:
            require_normals(self.face_normals, self.about.name)
        require_positive(
            self.about.name,
            angle_walk_deg_sqrt_h=self.angle_walk_deg_sqrt_h,
            bias_deg_h=self.bias_deg_h,
            bias_walk_deg_h_sqrt_h=self.bias_walk_deg_h_sqrt_h,
            reference_deg=self.reference_deg,
            gain_ageing_per_year=self.gain_ageing_per_year,
            shift_ageing_per_year=self.shift_ageing_per_year,
            worst_deg=self.worst_deg,
        )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the filter for the sensor's faces, or for a spot or balance."""
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        if kind is not FeatureKind.SIGNALS:
            return cls()
        geometry.require("face_normals", by=cls.about.name)
        return cls(face_normals=geometry.face_normals or ())

    def rule(self) -> Filter:
        """How beliefs go on: linearised at the estimate."""
        from algorithms.filtering.filters import ExtendedKalman  # noqa: PLC0415 - Numba

        return ExtendedKalman(self.considered_errors())

    def drifts(self) -> Sequence[Drift]:
        """Parameters of the sensor in the state: the light's strength before faces."""
        return (_LEVEL,) if self.face_normals else ()

    def uncertain(self, years: float) -> Sequence[Drift]:
        """Parameters of the sensor that are considered, not estimated, so long after calibration.

        What ages: gains of faces, offsets behind a spot.
        """
        if self.face_normals:
            gain = max(self.gain_ageing_per_year * years, _LEAST_AGED)
            return [Drift(GAINS + face, gain, 0.0) for face in range(len(self.face_normals))]
        shift = max(self.shift_ageing_per_year * years, _LEAST_AGED)
        return [Drift(place, shift, 0.0) for place in HEAD_SHIFTS[1:]]

    def considered_errors(self) -> tuple[int, ...]:
        """Which errors of the state are considered: those of `uncertain`, and the head's turn."""
        first, number = MOTION + len(self.drifts()), len(self.uncertain(0.0))
        turn = first + number
        return (*range(first, first + number), *range(turn, turn + 3))

    def columns(self) -> int:
        """One a face; two of a spot or balance."""
        return len(self.face_normals) or 2

    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Learn how the sensor reads Suns (N, 3), unit vectors, from features (N, F); self."""
        by = self.about.name
        found, vectors, usable = as_calibration_rows(
            features, sun, self.columns(), by, frontal=not self.face_normals
        )
        columns = as_context(context, self.about.context, len(usable), by)
        known = complete(columns, len(usable))[usable]
        columns = {name: column[usable] for name, column in columns.items()}
        known &= columns["eclipse"] == 0
        require_samples(int(known.sum()), FEWEST, by, "to learn how the sensor reads a Sun")
        order = np.flatnonzero(known)[np.argsort(columns["time_s"][known], kind="stable")]
        found, vectors = found[order], vectors[order]
        columns = {name: column[order] for name, column in columns.items()}
        learnt = replace(self)  # a refusal leaves no trace
        learnt.learn(found, vectors, columns)
        learnt.assess(found, vectors, columns)
        vars(self).update(vars(learnt))
        return self

    def learn(self, features: Floats, sun: Floats, columns: dict[str, Floats]) -> None:
        """Set readings, their noise, and what series begin from."""
        from algorithms.filtering.filter_calibration import (  # noqa: PLC0415 - Numba, at the first fit only
            FilterCalibration,
            least_variance,
        )

        known, normals = _known(columns), np.asarray(self.face_normals, dtype=np.float64)
        given = normals, features, sun, known, columns["time_s"]
        learnt = compute_once(
            (FilterCalibration, *given),
            lambda: FilterCalibration.from_calibration(*given, by=self.about.name),
        )
        self.readings_, self.noise_, self.steps_ = learnt.readings, learnt.noise, learnt.steps
        self.calibrated_s_, self.step_s_ = learnt.calibrated_s, learnt.step_s
        self.starts_ = learnt.starts
        if (self.steps_ <= _WHITE).all():
            gaps = np.diff(columns["time_s"], prepend=-np.inf)
            apart = np.where((gaps > 0) & (gaps <= _LONGEST * self.step_s_), gaps, np.inf)
            quiet = np.maximum(_QUIET * self.noise_, least_variance(features))
            self.noise_ = estimate_noise(self, features, self._known(columns), apart, quiet)

    def assess(self, features: Floats, sun: Floats, columns: dict[str, Floats]) -> None:
        """Set `quality_`: UnusableDataError where the filter does not follow its calibration."""
        found = self._answers(self._track(features, columns, _FEWEST_READ))
        error = separation_deg(found, sun)
        answered = error[np.isfinite(error)]
        residual = float(np.sqrt(np.mean(answered**2))) if len(answered) else np.inf
        spread = np.degrees(np.sqrt(((sun - sun.mean(axis=0)) ** 2).sum(axis=1).mean()))
        if not residual <= WORST_RESIDUAL * spread:
            raise UnusableDataError(
                f"{self.about.name}: the filter leaves {residual:.3g} deg on its own calibration, "
                f"whose Suns spread over {spread:.3g} deg: features, Suns, rates and times do not "
                "belong together"
            )
        self.quality_ = FitQuality(
            samples=len(features),
            residual_rms_deg=residual,
            data_digest=data_digest(features, sun, columns),
            settings=self.readings_.settings(),
        )

    def predict(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """Sun unit vectors (N, 3) of rows in the order of time; NaN where nothing was read."""
        require_fitted(self, "quality_")
        return self._answers(self._track(features, context, _FEWEST_READ))

    def deviation_deg(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """1-sigma (N,) of each answer's errors along a tangent axis, degrees."""
        require_fitted(self, "quality_")
        track = self._track(features, context, _FEWEST_READ)
        answered = np.isfinite(self._answers(track)[:, 0])
        return np.where(answered, track.deviation_deg, np.nan)

    def track(self, features: ArrayLike, context: Context | None = None) -> Track:
        """Follow the Sun through rows, those in the dark too, with what the filter thinks of it."""
        require_fitted(self, "starts_")
        return self._track(features, context, 1)

    def _track(self, features: ArrayLike, context: Context | None, fewest: int) -> Track:
        """Follow the Sun; series that have fewer rows to read are not begun, nor answered."""
        found = as_features(features, self.columns(), self.about.name)
        columns = as_context(context, self.about.context, len(found), self.about.name)
        usable = complete(columns, len(found)) & np.isfinite(found).all(axis=1)
        usable &= columns["eclipse"] == 0
        usable &= np.where(usable, self.readings_.is_sunlit(found), 0.0) > 0
        return self._follow(found, columns["time_s"], _known(columns), usable, fewest)

    def space(self, years: float = 0.0, noise: Floats | None = None) -> SunSpace:
        """State space of the sensor so long after its calibration, of its noise or another."""
        from algorithms.filtering.sun_space import SunSpace  # noqa: PLC0415 - Numba

        gyroscope = Gyroscope(
            float(np.radians(self.angle_walk_deg_sqrt_h / _ROOT_HOUR)),
            float(np.radians(self.bias_deg_h / _HOUR_S)),
            float(np.radians(self.bias_walk_deg_h_sqrt_h / (_HOUR_S * _ROOT_HOUR))),
        )
        return SunSpace(
            self.readings_,
            np.diag(self.noise_ if noise is None else noise),
            gyroscope,
            (*self.drifts(), *self.uncertain(years)),
            steps=self.steps_,
            turn=float(np.radians(self.reference_deg)),
        )

    def _follow(
        self,
        found: Floats,
        time_s: Floats,
        known: Floats,
        usable: NDArray[np.bool_],
        fewest: int,
    ) -> Track:
        space, by = self.space(), self.rule()
        tried = space.states_towards(self.starts_)
        drifts = len(self.drifts()) + len(self.uncertain(0.0))
        known = known - np.array([0.0] * 6 + [self.readings_.middle_k])
        count = len(found)
        states = np.full((count, space.errors + 7), np.nan)
        variance = np.full((count, space.errors), np.nan)
        squared, read = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)
        moving = np.isfinite(known[:, :3]).all(axis=1)
        steps = np.diff(time_s, prepend=-np.inf)
        follows = moving & (steps > 0) & (steps <= _LONGEST * self.step_s_)
        series = np.cumsum(~follows) - 1
        usable = usable & (np.bincount(series[usable], minlength=count)[series] >= fewest)
        years = (np.abs(time_s - self.calibrated_s_) / _YEAR_S).tolist()
        belief: Belief | None = None
        first = 0
        turns = zip(follows.tolist(), steps.tolist(), usable.tolist(), strict=True)
        for row, (goes_on, step_s, is_usable) in enumerate(turns):
            if not goes_on:
                belief, first = None, row
            elif belief is not None:
                belief = by.predict(space, belief, known[row], step_s)
            if is_usable and belief is None:
                space = self.space(years[first])  # a series is as old as its first row
                belief = space.start_belief(
                    by, tried, found[row], known[row], self.considered_errors()
                )
                read[row] = belief is not None
            elif is_usable and belief is not None:
                belief = by.update(space, belief, found[row : row + 1], known[row])
                squared[row] = belief.squared_innovation[belief.weights.argmax()]
                read[row] = squared[row] == squared[row]  # not NaN
            if belief is not None:
                best, covariance = by.estimate(space, belief)
                states[row], variance[row] = best[0], covariance[0].diagonal()
        return Track(
            sun=states[:, 6:9],
            deviation_deg=np.degrees(np.sqrt(0.5 * (variance[:, 0] + variance[:, 1]))),
            is_read=read,
            squared_innovation=squared,
            series=series,
            drift=states[:, 12 : 12 + drifts],
            drift_deviation=np.sqrt(variance[:, MOTION : MOTION + drifts]),
            bias_deg_h=np.degrees(states[:, 9:12]) * _HOUR_S,
        )

    def _answers(self, track: Track) -> Floats:
        """Directions of rows that were read, from a series' second reading on."""
        total = np.cumsum(track.is_read)
        start = np.zeros(int(track.series.max()) + 1)
        first = np.r_[True, np.diff(track.series) > 0]
        start[track.series[first]] = (total - track.is_read)[first]
        counted = total - start[track.series]
        held = track.is_read & (counted >= _FEWEST_READ) & (track.deviation_deg <= self.worst_deg)
        return np.where(held[:, None], track.sun, np.nan)

    def _known(self, columns: dict[str, Floats]) -> Floats:
        """(N, 7) what states and readings go by, warmth counted from the calibration's middle."""
        return np.asarray(_known(columns) - np.array([0.0] * 6 + [self.readings_.middle_k]))


def _known(columns: dict[str, Floats]) -> Floats:
    """(N, 7) what states and readings go by: rate in rad/s, nadir, temperature."""
    rate, nadir = np.radians(columns["rate_deg_s"]), columns["nadir"]
    return np.column_stack([rate, nadir, columns["temperature_K"]])
