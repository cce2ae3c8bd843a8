"""Kalman filters of the Sun's direction: one model, `SunFilter`, and a rule of update for each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.documented import documented
from algorithms.filtering.drift import EARTH, GAINS, HEAD_SHIFTS, HEAD_TURNS, Drift, random_walk
from algorithms.filtering.sequence import CONTEXT, SunFilter
from algorithms.parameters import require_positive

if TYPE_CHECKING:
    from algorithms.filtering.filters import Filter


_READS: dict[str, Any] = {"accepts": frozenset(FeatureKind), "context": CONTEXT, "version": 2}
#: Of filters that the survey names in its section on online methods, and says no more of.
_ONLINE: dict[str, Any] = {"taxonomy": "None", "labels": ("model:mnc",), **_READS}


@documented
@dataclass
class ExtendedKalmanFilter(SunFilter):
    """Extended Kalman filter of the Sun direction in a rotating body.

    The gyroscope propagates the direction from sample to sample; each reading corrects it by the
    calibrated measurement function. Dynamics and measurements are linearised at the estimate.

    Notes
    -----
    Implements: EKF, of the survey's online methods (model:mnc).

    Cost: 20 us per step on the development machine.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = ExtendedKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="extended-kalman", **_ONLINE)


@documented
@dataclass
class CubatureKalmanFilter(SunFilter):
    """Cubature Kalman filter of the Sun direction in a rotating body.

    Covariances are propagated by the cubature rule of third degree: 2 n points of equal weight,
    none in the centre. It has no tuning parameter and no negative weight.

    Notes
    -----
    Implements: CKF, of the survey's online methods (model:mnc).

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = CubatureKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="cubature-kalman", **_ONLINE)

    def rule(self) -> Filter:
        """Take the cubature rule's points."""
        from algorithms.filtering.filters import CUBATURE  # noqa: PLC0415 - Numba

        return replace(CUBATURE, considered=self.considered_errors())


@documented
@dataclass
class UnscentedKalmanFilter(SunFilter):
    """Unscented Kalman filter of the Sun direction in a rotating body.

    Covariances are propagated by points on both sides of the estimate, which includes curvature
    and needs no derivatives. The points of directions lie on the sphere.

    Parameters
    ----------
    kappa : float
        Spread of the points, at least 0: their distance is ``sqrt(n + kappa)`` standard deviations.

    Notes
    -----
    Implements: UKF, of the survey's online methods (model:mnc).

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = UnscentedKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="unscented-kalman", **_ONLINE)

    kappa: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.kappa < float("inf"):
            raise ValueError(f"{self.about.name}: kappa must be 0 or more; got {self.kappa!r}")

    def rule(self) -> Filter:
        """Take points on both sides."""
        from algorithms.filtering.filters import SigmaPointKalman  # noqa: PLC0415 - Numba

        return SigmaPointKalman(kappa=self.kappa, considered=self.considered_errors())


@documented
@dataclass
class RobustKalmanFilter(SunFilter):
    """Extended Kalman filter with bounded influence of outliers.

    An innovation beyond a number of standard deviations gets a proportionally larger variance
    (Huber), so its influence is bounded. Readings within this limit have full weight.

    Parameters
    ----------
    limit : float
        Number of standard deviations up to which a reading has full weight, positive.

    Notes
    -----
    Implements: RKF, of the survey's online methods (model:mnc).

    Cost: 30 us per step on the development machine.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = RobustKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="robust-kalman", **_ONLINE)

    limit: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.about.name, limit=self.limit)

    def rule(self) -> Filter:
        """Weigh readings by how far off they are."""
        from algorithms.filtering.filters import RobustKalman  # noqa: PLC0415 - Numba

        return RobustKalman(self.considered_errors(), limit=self.limit)


@documented
@dataclass
class AdaptiveKalmanFilter(SunFilter):
    """Extended Kalman filter that estimates the measurement noise while running.

    The measurement noise of the next update is the running mean of squared residuals plus the
    remaining uncertainty of the state. It is overconfident if errors are correlated in time.

    Parameters
    ----------
    window : float
        Number of readings over which the noise is averaged, above 1.

    Notes
    -----
    Implements: AKF, of the survey's online methods (model:mnc): ``R
    <- R + (e e' + H P H' - R) / window``.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = AdaptiveKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="adaptive-kalman", **_ONLINE)

    window: float = 50.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 < self.window < float("inf"):
            raise ValueError(f"{self.about.name}: window must be above 1; got {self.window!r}")

    def rule(self) -> Filter:
        """Let the noise follow the residuals."""
        from algorithms.filtering.filters import AdaptiveKalman  # noqa: PLC0415 - Numba

        return AdaptiveKalman(self.considered_errors(), window=self.window)


@documented
@dataclass
class MultipleModelEstimation(SunFilter):
    """Mixture of extended Kalman filters with different measurement noise.

    Each filter assumes another multiple of the calibration's noise and is weighted by the
    likelihood of all readings so far. The answer is the weighted mean of their directions.

    Parameters
    ----------
    noise_scales : tuple of float
        Standard deviation assumed by each filter, relative to that of the calibration; positive.

    Notes
    -----
    Implements: MMAE (Magill's bank), of the survey's online methods (model:mnc).

    Cost: 50 us per step on the development machine.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = MultipleModelEstimation().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(name="multiple-models", **_ONLINE)

    noise_scales: tuple[float, ...] = (0.25, 1.0, 4.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.noise_scales:
            raise ValueError(f"{self.about.name}: noise_scales must not be empty")
        for scale in self.noise_scales:
            require_positive(self.about.name, noise_scales=scale)

    def rule(self) -> Filter:
        """Keep a filter for each scale."""
        from algorithms.filtering.hypotheses import MultipleModels  # noqa: PLC0415 - Numba

        return MultipleModels(tuple(self.noise_scales), considered=self.considered_errors())


@documented
@dataclass
class ConsiderKalmanFilter(SunFilter):
    """Extended Kalman filter that accounts for calibration errors without estimating them.

    Errors of gains and of the Earth's brightness (for spots: of focal length and offsets) are
    considered: their covariance and their correlation with the direction enter every filter gain,
    but they are not estimated. So the stated covariance includes errors that do not average out.

    Parameters
    ----------
    gain_deviation : float
        Standard deviation of the relative gain error of each face, positive.
    albedo_deviation : float
        Standard deviation of the albedo relative to the calibrated albedo, positive.
    shift_deviation : float
        Standard deviation of the offsets over the focal length, and of the relative focal length,
        positive.

    Notes
    -----
    Implements: model:mnc (OKeefe2017, eq:mnoise), ``V = C (V_d + V_alpha + nu)`` with the
    calibration factors C and the strength of the albedo V_alpha considered. The survey prints
    V_alpha negative; corrected because light adds. V_d and V_alpha are as the calibration found
    them: a cubic of the cosine in place of the cosine, polynomials of nadir in place of the
    integral over the Earth (ours). ``K = P H' S^-1`` with the rows of what is considered set to
    nothing; Joseph's form.

    Cost: 30 us per step on the development machine, for six faces.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = ConsiderKalmanFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(
        name="consider-kalman",
        taxonomy="ECM/Noise",
        studies=("OKeefe2017",),
        labels=("model:mnc", "eq:mnoise"),
        origin="survey",
        **_READS,
    )

    gain_deviation: float = 0.01
    albedo_deviation: float = 0.3
    shift_deviation: float = 3e-4

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(
            self.about.name,
            gain_deviation=self.gain_deviation,
            albedo_deviation=self.albedo_deviation,
            shift_deviation=self.shift_deviation,
        )

    def uncertain(self, years: float) -> Sequence[Drift]:
        """Consider gains and the Earth, or focal length and offsets, however long ago."""
        del years
        faces = len(self.face_normals)
        if faces:
            gains = (Drift(GAINS + face, self.gain_deviation, 0.0) for face in range(faces))
            return (Drift(EARTH, self.albedo_deviation, 0.0), *gains)
        return tuple(Drift(place, self.shift_deviation, 0.0) for place in HEAD_SHIFTS)


@documented
@dataclass
class AssemblyDriftFilter(SunFilter):
    """Extended Kalman filter of the Sun direction and of the sensor's assembly.

    The state contains the direction and the assembly: gains and normals of faces, or, for spots,
    rotation, focal length and offsets. The assembly explains the changes of the readings that the
    measured rotation of the body does not explain. Each assembly parameter is a random walk with
    the given standard deviation per day.

    Parameters
    ----------
    gain_deviation : float
        Standard deviation of the relative gain error, positive; one per face.
    turn_deviation_deg : float
        Standard deviation of the rotation of each face's normal (for spots: of the head) about each
        axis, positive.
    shift_deviation : float
        Standard deviation of the offsets over the focal length, and of the relative focal length,
        positive.

    Notes
    -----
    Implements: model:assem (Radan2019), in orbit: installation error, offsets of the detector and
    misalignment by EKF, from what the calibration on the ground found (assembled-faces is its half
    on the ground, for faces). The survey gives no equations since every sensor has its own (ours).

    Cost: 40 us per step on the development machine, for six faces.

    Examples
    --------
    >>> from algorithms.examples import turning_body
    >>> spots, sun, context = turning_body()
    >>> model = AssemblyDriftFilter().fit(spots, sun, context)
    >>> model.predict(spots, context)[-1].round(2)
    array([0.49, 0.38, 0.79])
    """

    about: ClassVar = AboutModel(
        name="assembly-drift",
        taxonomy="ACM",
        studies=("Radan2019",),
        labels=("model:assem", "model:mnc"),
        origin="survey",
        **_READS,
    )

    gain_deviation: float = 0.01
    turn_deviation_deg: float = 0.05
    shift_deviation: float = 3e-4

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(
            self.about.name,
            gain_deviation=self.gain_deviation,
            turn_deviation_deg=self.turn_deviation_deg,
            shift_deviation=self.shift_deviation,
        )

    def uncertain(self, years: float) -> Sequence[Drift]:
        """Nothing: what ages is estimated."""
        del years
        return ()

    def drifts(self) -> Sequence[Drift]:
        """Everything about the assembly, beside the light's strength."""
        faces, turn = len(self.face_normals), math.radians(self.turn_deviation_deg)
        if faces:
            gains = [random_walk(GAINS + face, self.gain_deviation) for face in range(faces)]
            tilts = [random_walk(GAINS + faces + tilt, turn) for tilt in range(2 * faces)]
            return (*super().drifts(), *gains, *tilts)
        turns = [random_walk(place, turn) for place in HEAD_TURNS]
        return (*turns, *(random_walk(place, self.shift_deviation) for place in HEAD_SHIFTS))
