"""Directions that an experiment of their own decides: lasers that pass for the Sun."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from scipy.special import bdtr, betaincinv

from benchmark.directions.duels import Duel
from benchmark.directions.rules import NOT_TRIED
from benchmark.experiments.spoofing import SENSORS
from benchmark.spoofing.record import level_of

Row = Mapping[str, Any]

#: The laser that decides, of so many Suns; share that must be noticed; false alarms a reading.
SUNS, NOTICED, FALSE_ALARMS = 1.0, 0.99, 1e-4
#: Of so many alarms of clean readings or more, below which they contradict the rate.
_CHANCE = 0.05


class Trial(NamedTuple):
    """What came of it: as `benchmark.directions.paper.Calculation`, with a row a sensor or duel."""

    verdict: str
    text: str
    value: float | None
    against: float | None
    unit: str
    sensors: Sequence[Row] = ()
    duels: Sequence[Duel] = ()


def not_tried(_: Sequence[Row]) -> Trial:
    """Say that an experiment has a rule and no outcome yet."""
    return Trial(NOT_TRIED, "Not tried: the experiment of the rule has not run.", None, None, "")


def laser(rows: Sequence[Row]) -> Trial:
    """Decide by the rows of the experiment: who notices a laser as bright as the Sun beside it."""
    sensors = [_sensor(row) for row in rows]
    deciding = [one for one in sensors if one["has_pattern"] and one["noticed"] is not None]
    if not deciding:
        return Trial(NOT_TRIED, "Not tried: no laser was simulated.", None, None, "")
    passed = [one["noticed"] >= NOTICED and one["keeps_rate"] for one in deciding]
    decided = "depends on the data set"
    if all(passed) or not any(passed):
        decided = "pays" if all(passed) else "does not pay"
    worst = min(deciding, key=lambda one: float(one["noticed"]))
    believed = [one for one in deciding if one["deceived"] >= 0.5]
    text = (
        f"A laser as bright as the Sun beside it deceives {len(believed)} of {len(deciding)} "
        "pipelines behind masks in half of the readings or more. At one false alarm in 10,000 the "
        f"residual of the pattern notices 99 % or more on {sum(passed)}; least on "
        f"{worst['dataset']}, {100 * worst['noticed']:.1f} %."
    )
    if worst["knowable"] is not None and worst["noticed"] < NOTICED:
        text += (
            " Physics forbids 99 % there: four currents leave one number beside direction and "
            "brightness, which two lights in one row or column do not change; a test that knew the "
            f"unit exactly would notice {100 * worst['knowable']:.1f} %. Brightness and residual "
            f"together notice {100 * worst['either']:.1f} %."
        )
    alone = [level_of(row, SUNS, sun=False) for row in rows if row["has_pattern"]]
    answered = [(one["answered"], one["turned"] - one["answered"], one) for one in alone]
    seen = [100 * (one["noticed"]["pattern"] - no) / yes for yes, no, one in answered if yes]
    if seen:
        text += (
            " Without the Sun the laser passes for it: only the Sun's disc and colours tell, and "
            f"the residual notices {min(seen):.0f} to {max(seen):.0f} % of the answers."
        )
    for row in (row for row in rows if row["has_pattern"] and row["rises"]):
        rises = row["rises"]
        quick, slow = (100 * rises[k]["noticed"] / rises[k]["draws"] for k in (0, -1))
        text += (
            f" On {row['dataset']} a filter's innovation notices {quick:.0f} % at once and "
            f"{slow:.0f} % of lasers that rise over {rises[-1]['readings']:g} readings."
        )
    if loud := [one["dataset"] for one in deciding if not one["keeps_rate"]]:
        text += f" More false alarms than that, which does not count: {', '.join(loud)}."
    if missing := sorted(SENSORS.keys() - {row["dataset"] for row in rows}):
        text += f" Not measured yet: {', '.join(missing)}."
    return Trial(decided, text, worst["noticed"], NOTICED, "share noticed, worst sensor", sensors)


def _sensor(row: Row) -> dict[str, Any]:
    """Return what a row says of the deciding laser, as shares."""
    level = level_of(row, SUNS)
    turned, alarms = level["turned"], row["alarms"]["pattern"]

    def share(name: str) -> float | None:
        count = level["noticed"].get(name)
        return round(count / turned, 5) if turned and count is not None else None

    noticed = level["noticed"]["pattern"]
    # Clopper and Pearson's
    low = betaincinv(noticed, turned - noticed + 1, 0.025) if noticed else 0.0
    high = betaincinv(noticed + 1, turned - noticed, 0.975) if noticed < turned else 1.0
    names = ("dataset", "extractor", "model", "has_pattern", "own_error_deg", "knowable")
    return {
        **{name: row[name] for name in names},
        "readings": level["readings"],
        "deceived": round(level["deceived"] / level["readings"], 5),
        "pull_deg": level["pull_deg"],
        "noticed": share("pattern"),
        "noticed_low": round(float(low), 5),
        "noticed_high": round(float(high), 5),
        "either": share("either"),
        "agreement": share("agreement"),
        "clean": row["answered"],
        "false_alarms": alarms,
        "keeps_rate": alarms == 0
        or bool(1.0 - bdtr(alarms - 1, row["answered"], FALSE_ALARMS) >= _CHANCE),
    }
