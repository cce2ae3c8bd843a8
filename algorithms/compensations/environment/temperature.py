"""The temperature of photodiodes, taken out of their signals (SECM/Temperature)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import Normals, require_normals

SMALLEST_SPREAD_K = 2.0
"""Standard deviation of the temperature below which a calibration tells nothing of it."""

SURELY_LIT = 0.2
"""Cosine by the drawing from which on a face's sample tells of its temperature coefficient."""

FEWEST_LIT = 12
"""Samples that must light a face."""

_ROUNDS = 10


@documented
@dataclass
class TemperatureDrift(CalibratedCompensation):
    """Signals converted to one temperature by a temperature coefficient per face.

    A photodiode's current grows by some hundredths of a per cent per kelvin, slightly differently
    for each; the common part cancels in a direction, the differences do not.

    Attributes
    ----------
    coefficients_ : ndarray, shape (K,)
        C of each face, relative change a kelvin at `reference_k_`.
    deviations_ : ndarray, shape (K,)
        Their standard errors.
    reference_k_ : float
        Mean temperature of the calibration, K.

    Notes
    -----
    Implements: eq:tempcomp (model:temp, Lu2017a): ``I / (1 + C (T - T_0))`` of every face; the
    choice of the brighter of two opposite ones, which gives the sign k, is the model's behind.
    The study takes C from the data sheet; here it is learnt, a face each: its signal is a cubic of
    the cosine by the drawing times ``1 + C (T - T_0)``, fitted by least squares in turns.

    Shapes: signals (N, K), in any common unit, to the same. Context: ``temperature_K`` (N,).

    Failure: a NaN row for a NaN feature row or temperature. fit raises UnusableDataError where the
    temperature stays the same, or fewer than 12 samples light a face.

    Cost: 3 operations per face.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals, sun_grid
    >>> faces = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> sun, warm = sun_grid(range(-20, 21, 5)), {"temperature_K": 270 + 37 * np.arange(81) % 61}
    >>> fall = 1 + 1e-3 * (warm["temperature_K"] - 300)[:, None]
    >>> drift = TemperatureDrift(faces).fit(face_signals(sun, faces) * fall, sun, warm)
    >>> ratio = drift.transform(face_signals(sun, faces) * fall, warm) / face_signals(sun, faces)
    >>> float(np.ptp(ratio / ratio[0, 0]).round(6))
    0.0
    """

    about: ClassVar = AboutCompensation(
        name="temperature",
        taxonomy="SECM/Temperature",
        studies=("Lu2017a",),
        labels=("model:temp", "eq:tempcomp"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("temperature_K",),
        ahead_of=(
            "basic",
            "assembled-faces",
        ),
    )
    frontal: ClassVar[bool] = False

    face_normals: Normals

    coefficients_: Floats = field(init=False, repr=False, compare=False)
    deviations_: Floats = field(init=False, repr=False, compare=False)
    reference_k_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_normals(self.face_normals, self.about.name)

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn every face's temperature coefficient."""
        by, temperature = self.about.name, context["temperature_K"]
        if not np.std(temperature) >= SMALLEST_SPREAD_K:
            raise UnusableDataError(
                f"{by} needs calibration samples at different temperatures, spread by at least "
                f"{SMALLEST_SPREAD_K:g} K; theirs spread by {np.std(temperature):.3g} K"
            )
        reference = float(np.mean(temperature))
        warmer = temperature - reference
        cosines = sun @ np.asarray(self.face_normals, dtype=np.float64).T
        count = len(self.face_normals)
        coefficients, deviations = np.empty(count), np.empty(count)
        for face in range(count):
            lit = cosines[:, face] > SURELY_LIT
            if lit.sum() < FEWEST_LIT:
                raise UnusableDataError(
                    f"{by}: face {face + 1} is lit by {int(lit.sum())} calibration samples; at "
                    f"least {FEWEST_LIT} must light it"
                )
            coefficients[face], deviations[face] = _coefficient(
                features[lit, face], cosines[lit, face], warmer[lit]
            )
        self.coefficients_, self.deviations_ = coefficients, deviations
        self.reference_k_ = reference

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, K) at the reference temperature."""
        warmer = context["temperature_K"] - self.reference_k_
        return np.asarray(features / (1.0 + self.coefficients_ * warmer[:, None]))


def _coefficient(signal: Floats, cosine: Floats, warmer: Floats) -> tuple[float, float]:
    """Relative change a kelvin of one face's signals (n,), and its standard error."""
    powers = np.stack([cosine**k for k in range(4)], axis=1)
    coefficient = 0.0
    for _ in range(_ROUNDS):
        shape = powers @ np.linalg.lstsq(powers, signal / (1 + coefficient * warmer), rcond=None)[0]
        # a change of the level goes with the temperature's own mean among these samples
        design = np.stack([shape, shape * warmer], axis=1)
        level, slope = np.linalg.lstsq(design, signal, rcond=None)[0]
        coefficient = float(slope / level)
    residual = signal - design @ (level, slope)
    variance = residual @ residual / max(len(signal) - 6, 1)
    spread = np.linalg.inv(design.T @ design)[1, 1]
    return coefficient, float(np.sqrt(variance * spread) / level)
