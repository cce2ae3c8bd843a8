"""A kink of the table's angles at their zero: one half of an axis of another scale."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from algorithms.angles import angles_from_sun
from algorithms.contract import FeatureKind, Floats
from api.calibrate.conventions.finding import Finding
from api.calibrate.readings import Readings
from api.calibrate.robust import degree_for, terms
from api.calibrate.settings import Settings

_MOST, _FEWEST = 2000, 100
_BLOCKS, _CERTAIN = 8, 6.0
#: Share of what a smooth function leaves that the kink explains, and the least change of slope.
_SHARE = 0.05
_LEAST = 0.01


def of_kinks(readings: Readings, settings: Settings, noise_deg: float) -> Iterator[Finding]:
    """Yield axes of the table whose angles bend at zero, as no smooth function of readings does.

    Channels are left out: light that leaves a face bends its signal at the same place.
    """
    if readings.kind is FeatureKind.SIGNALS or len(readings) < _FEWEST:
        return
    used = readings.thinned(_MOST)
    angles = angles_from_sun(used.sun) if used.angles is None else used.angles
    names = settings.direction.columns if used.angles is not None else ("alpha", "beta")
    azimuth = settings.direction.form.startswith("azimuth")
    for at, name in enumerate(names):
        if azimuth or not (angles[:, at] < 0).any() or not (angles[:, at] > 0).any():
            continue
        bend, error, share = _bend(used, angles[:, at])
        moved = abs(bend) * float(np.std(np.maximum(angles[:, at], 0.0)))
        if share > _SHARE and abs(bend) > max(_CERTAIN * error, _LEAST) and moved > 0.5 * noise_deg:
            yield Finding(
                "kink",
                f"angles of {name} above zero seem to be {100 * abs(bend):.2g} % "
                f"{'larger' if bend > 0 else 'smaller'} than those below, as readings change with "
                "them",
                moved, noise_deg, {}, True,
                "a sensor of which one half responds otherwise looks alike",
            )  # fmt: skip


def _bend(readings: Readings, angle: Floats) -> tuple[float, float, float]:
    """Return the change of slope of an angle (N,) at zero, its error, and what it explains.

    Angles are a smooth function of the readings and of the angle above zero. The error is that of a
    jackknife of blocks; explained is a share of the variance that the smooth function leaves.
    """
    features = readings.features
    scaled = (features - features.mean(axis=0)) / np.maximum(features.std(axis=0), 1e-12) / 2.0
    design = np.linalg.qr(terms(scaled, degree_for(len(angle), features.shape[1])))[0]
    tangents = readings.sun[:, :2] / readings.sun[:, 2:]
    along = [abs(float(np.corrcoef(angle, tangents[:, at])[0, 1])) for at in (0, 1)]
    tangent = tangents[:, int(np.argmax(along))]
    # what images tangents is smoother over them than over angles
    forms = [(np.var(_rest(design, form)) / np.var(form), form) for form in (angle, tangent)]
    used = min(forms, key=lambda one: one[0])[1]
    hinge_left, left = _rest(design, np.maximum(used, 0.0)), _rest(design, used)
    kept = np.abs(left) <= 6.0 * np.median(np.abs(left))
    other = tangents[:, int(np.argmin(along))]
    block = np.argsort(np.argsort(other)) * _BLOCKS // len(other)
    whole = _ratio(hinge_left[kept], left[kept])
    without = np.array(
        [_ratio(hinge_left[kept & (block != n)], left[kept & (block != n)]) for n in range(_BLOCKS)]
    )
    scatter = float(np.sum((without - without.mean()) ** 2))
    rest = float(np.var(left[kept] - whole * hinge_left[kept]))
    share = 1.0 - rest / max(float(np.var(left[kept])), 1e-300)
    return whole, float(np.sqrt((_BLOCKS - 1) / _BLOCKS * scatter)), share


def _rest(design: Floats, column: Floats) -> Floats:
    return np.asarray(column - design @ (design.T @ column))


def _ratio(hinge: Floats, left: Floats) -> float:
    return float(hinge @ left / max(float(hinge @ hinge), 1e-300))
