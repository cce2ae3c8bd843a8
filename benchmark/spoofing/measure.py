"""What one worker does: one sensor and pipeline under a laser of every level, and what notices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.pattern_residual import tail_threshold
from algorithms.contract import Floats
from benchmark.metrics.separation import separation_deg, store
from benchmark.simulator.scene import Scene
from benchmark.spoofing.readings import Calibrated, Read

#: Signal of the laser over that of the mean Sun; the level that decides; false alarms a reading.
SUNS, DECIDING, FALSE_ALARMS = (0.1, 0.3, 1.0, 3.0, 10.0), 1.0, 1e-4
#: Of the curves that a page shows.
RATES = (1e-1, 1e-2, 1e-3, 1e-4)
#: An answer that is off by more than so many of its own errors is believed wrongly.
TURNED = 10.0
#: Readings over which a laser rises to one Sun, how often, and the gain of the filter before it.
RISES, RISE_DRAWS, GAIN = (1, 10, 100, 1000), 60, 0.1
_KNOWN_DRAWS = 1000


@dataclass(frozen=True)
class Counts:
    """Clean readings that set thresholds and check them; with the deciding laser, with others."""

    setting: int
    checking: int
    deciding: int
    others: int


@dataclass(frozen=True)
class SpoofTask:
    """A sensor with its pipeline, and bare faces beside it, None without."""

    one: Calibrated
    beside: Calibrated | None
    counts: Counts

    @property
    def few_elements(self) -> bool:
        """Whether it has so few elements that bounds and rises are cheap."""
        return str(self.one.preset.observation) == "currents"


@dataclass(frozen=True)
class _Tests:
    """Statistics that alarm above a threshold, of readings that set it."""

    clean: Mapping[str, Floats]

    def threshold(self, name: str, rate: float) -> float:
        clean = self.clean[name]
        finite = int(np.isfinite(clean).sum())
        return tail_threshold(clean, rate, max(0.05, min(20.0 / finite, 0.5)))

    def alarms(self, found: Mapping[str, Floats], name: str, rate: float) -> NDArray[np.bool_]:
        """Say which readings alarm; those without an answer do."""
        values = found[name]
        return np.asarray(~(values <= self.threshold(name, rate)))


def measure(task: SpoofTask) -> dict[str, Any]:
    """Return the row of a sensor: how often it is deceived, by how much, and what notices."""
    one, counts = task.one, task.counts
    scene = one.drawn(counts.setting, "setting")
    clean = one.read(scene, "setting")
    middle = float(np.nanmedian(clean.brightness))
    statistics = partial(_statistics, middle=middle)
    tests = _Tests(statistics(clean, _beside(task, scene, clean.answers, "setting")))
    checked = one.drawn(counts.checking, "checking")
    again = one.read(checked, "checking")
    errors = again.errors_deg(checked.sun)
    own = math.sqrt(float(np.nanmean(errors**2)))
    found = statistics(again, _beside(task, checked, again.answers, "checking"))
    answered = np.isfinite(errors)
    levels = [
        _level(task, tests, statistics, own, suns, with_sun=with_sun)
        for with_sun in (True, False)
        for suns in SUNS
    ]
    return {
        "dataset": one.preset.name,
        "extractor": one.extractor.about.name,
        "model": one.model.about.name,
        "has_pattern": one.preset.mask != "Maskless",
        "own_error_deg": store(own),
        "setting": counts.setting,
        "checking": counts.checking,
        "answered": int(answered.sum()),
        "flagged": int((again.flags != 0).sum()),
        "alarms": {
            name: int(tests.alarms(found, name, FALSE_ALARMS)[answered].sum()) for name in found
        },
        "knowable": _knowable(task) if task.few_elements else None,
        "levels": levels,
        "rises": _rises(task, errors[answered], own) if task.few_elements else [],
    }


def _statistics(read: Read, apart: Floats | None, *, middle: float) -> dict[str, Floats]:
    """Return what is compared with thresholds, (N,) each, by the name of the test."""
    with np.errstate(divide="ignore", invalid="ignore"):
        bright = np.abs(np.log(np.maximum(read.brightness, 1e-6) / middle))
    found = {"pattern": read.pattern, "brightness": bright}
    if apart is not None:
        # where the faces have no answer there is nothing to disagree with
        compared = np.where(np.isfinite(apart), apart, 0.0)
        found["agreement"] = np.where(np.isfinite(read.answers[:, 0]), compared, np.nan)
    return found


def _beside(
    task: SpoofTask,
    scene: Scene,
    answers: Floats,
    *names: str,
    laser: Floats | None = None,
    suns: float = 0.0,
) -> Floats | None:
    """Angles (N,) between the answers of the sensor and of the faces beside it, same lights."""
    if task.beside is None:
        return None
    seen = replace(task.beside.seeing(scene.sun, *names), irradiance=scene.irradiance)
    faces = task.beside.read(seen, *names, laser=laser, suns=suns).answers
    return separation_deg(answers, faces)


def _level(
    task: SpoofTask, tests: _Tests, statistics: Any, own: float, suns: float, *, with_sun: bool
) -> dict[str, Any]:
    one, deciding = task.one, with_sun and suns == DECIDING
    count = task.counts.deciding if deciding else task.counts.others
    named = "beside" if with_sun else "alone"
    scene = one.drawn(count, named)
    laser = one.lasers(scene, named)
    if not with_sun:
        scene = one.alone(scene, laser, named)
    read = one.read(scene, named, laser=laser, suns=suns)
    apart = _beside(task, scene, read.answers, named, laser=laser, suns=suns)
    found = statistics(read, apart)
    errors = read.errors_deg(scene.sun)
    # without a Sun every answer is a wrong one
    wrong = errors > TURNED * own if with_sun else np.isfinite(errors)
    turned = wrong | ~np.isfinite(errors)
    deceived = wrong & (read.flags == 0)
    noticed = {name: int(tests.alarms(found, name, FALSE_ALARMS)[turned].sum()) for name in found}
    either = [tests.alarms(found, name, FALSE_ALARMS / 2.0) for name in ("pattern", "brightness")]
    return {
        "sun": with_sun,
        "suns": suns,
        "readings": count,
        "answered": int(np.isfinite(errors).sum()),
        "flagged": int((read.flags != 0).sum()),
        "deceived": int(deceived.sum()),
        "pull_deg": store(float(np.median(errors[deceived])))
        if with_sun and deceived.any()
        else None,
        "turned": int(turned.sum()),
        "noticed": {**noticed, "either": int((either[0] | either[1])[turned].sum())},
        "curve": [int(tests.alarms(found, "pattern", rate)[turned].sum()) for rate in RATES],
    }


def _knowable(task: SpoofTask) -> float | None:
    """Share of lasers of one Sun that the chi-square notices which the best single light leaves.

    Of a known unit; its degrees of freedom are the elements beyond direction and brightness.
    """
    from scipy.stats import chi2, ncx2  # noqa: PLC0415 - SciPy on demand

    one = task.one
    scene = one.drawn(_KNOWN_DRAWS, "known")
    laser = one.lasers(scene, "known")
    read = one.read(scene, "known", laser=laser, suns=DECIDING)
    kept = np.isfinite(read.answers).all(axis=1)
    scene, laser = scene.rows(np.flatnonzero(kept)), laser[kept]
    mean, variance = one.expected(scene, laser, DECIDING)
    squares = one.fit_one_light(scene, read.answers[kept], mean, variance)
    freedom = mean.shape[1] - 3
    least = chi2.isf(FALSE_ALARMS, freedom)
    return store(float(np.mean(ncx2.sf(least, freedom, np.maximum(squares, 1e-9)))))


def _rises(task: SpoofTask, errors_deg: Floats, own: float) -> list[dict[str, Any]]:
    """Share of lasers that a filter's innovation notices while they rise to one Sun.

    It knows how the body turns and has settled, weighs a reading by `GAIN` and so innovates by
    ``1 / (1 - GAIN)`` times a reading's variance; errors of clean readings set its threshold.
    """
    one, found = task.one, []
    limit = tail_threshold(errors_deg**2, FALSE_ALARMS) / (1.0 - GAIN)
    for rise in RISES:
        scene = one.drawn(RISE_DRAWS, "rise")
        laser = one.lasers(scene, "rise")
        estimate, noticed = scene.sun.copy(), np.zeros(RISE_DRAWS, dtype=np.bool_)
        for step in range(1, rise + 1):
            answers = one.read(
                scene, "rise", rise, step, laser=laser, suns=DECIDING * step / rise
            ).answers
            apart = separation_deg(answers, estimate)
            noticed |= ~(apart**2 <= limit)
            moved = np.where(noticed[:, None], estimate, estimate + GAIN * (answers - estimate))
            estimate = moved / np.linalg.norm(moved, axis=1, keepdims=True)
        off = separation_deg(estimate, scene.sun)[~noticed]
        found.append(
            {
                "readings": rise,
                "draws": RISE_DRAWS,
                "noticed": int(noticed.sum()),
                "off_deg": store(float(np.median(off))) if len(off) else None,
                "over_own": store(float(np.median(off)) / own) if len(off) else None,
            }
        )
    return found
