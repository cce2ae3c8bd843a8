"""What a run is judged by beyond labels: title, sensor, calibration and score, all from tables.

Facts of a study are the rows of `run_facts.csv`, and figures of its sensor in `hardware.csv` that
were seen on a page. Against them stand the design of the data set that the study is shown on, the
implementations that run, and what was measured.

A fact that the run contradicts *differs*; one that is needed and not known is *unknown*:

- the study's title, and which publication its key means;
- the arrangement of its faces or openings, and the dimensions that its kind of sensor has
  (`needed`): each known one within a factor of `FACTOR`, less than `UNKNOWN_SHARE` of them unknown;
- parts and steps that the study states and that nothing here has;
- how it comes by its constants: fitted, in flight, or from its drawing;
- an accuracy that it reports: the own error here within a factor of `SCORE_FACTOR`, but for a
  reason in the table.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from registry.catalogue import Catalogue
from registry.fidelity.particulars import DIMENSIONS, DRAWN
from registry.fidelity.purposes import DataSet
from registry.fidelity.runnable import Departure, RunnablePipeline
from registry.studies import Facts, Study

FACTOR = 1.5
"""Times by which a dimension may be another than the study's."""
UNKNOWN_SHARE = 0.4
"""Share of a sensor's dimensions from which on their being unknown is said."""
SCORE_FACTOR = 3.0
"""Times by which the own error may be another than the accuracy that a study reports."""

Scores = Mapping[tuple[str, str, str, str], float | None]
"""Own error, degrees, by data set, condition, extractor and model; None without one."""

NAMES: Mapping[str, str] = {
    "layout": "arrangement",
    "faces": "number of faces",
    "openings": "number of openings",
    "subfields": "sub-fields an axis",
    "tilt_deg": "tilt of the faces, deg",
    "opening_um": "width of an opening, um",
    "height_mm": "height, mm",
    "pitch_um": "pixel pitch, um",
    "array_px": "pixels along the array",
    "fov_deg": "field, deg",
}
"""Facts of a sensor in words."""

#: Values of a detector that one another's four cells are called.
_FOUR_CELLS = frozenset({"PD", "QPD"})
_COUNTED = ("Multi-Ap.", "Multi-Slit", "Encoded")


def needed(design: Mapping[str, float | str], mask: str) -> tuple[str, ...]:
    """Name what has to be known of a sensor of this kind."""
    if "faces" in design:
        return ("layout", "faces", *(("tilt_deg",) * ("pyramid" in str(design["layout"]))))
    counted = ("openings",) * (mask in _COUNTED)
    pixels = tuple(name for name in ("pitch_um", "array_px") if name in design)
    return (*counted, "opening_um", "height_mm", *pixels, "fov_deg")


def differing(study: Study, facts: Facts, at: DataSet, sensor: tuple[str, str]) -> list[str]:
    """Say in what a data set is another sensor than the study's, a clause for each fact."""
    found = []
    for name, values in _known(study, facts).items():
        ours: float | str | None = at.design.get(name)
        if name in ("detector", "mask"):
            ours = sensor[name == "mask"]
            if any(one.value == ours and _is_seen(one.basis) for one in study.values.get(name, ())):
                continue
        if ours is not None and not any(_alike(name, value, ours) for value in values):
            what = NAMES.get(name, name)
            found.append(f"{what} {' or '.join(values)}, here {_plain(ours)}")
    return found


def unknown_of_sensor(
    study: Study, facts: Facts, at: DataSet, sensor: tuple[str, str]
) -> tuple[list[str], int]:
    """Return what is needed of the sensor and not known, and how much is needed."""
    wanted = needed(at.design, sensor[1])
    known = _known(study, facts)
    return [name for name in wanted if not known.get(name)], len(wanted)


def distance(study: Study, facts: Facts, at: DataSet) -> float:
    """Return how far a data set made after the study is from its numbers: a sum of logarithms."""
    total = 0.0
    if study.key not in at.follows:
        return total
    for name, values in _known(study, facts).items():
        ours = at.design.get(name)
        if isinstance(ours, float) and name in NAMES:
            total += min(abs(math.log(float(value) / ours)) for value in values)
    return total


def _known(study: Study, facts: Facts) -> Mapping[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for one in facts.run_facts.get(study.key, ()):
        if one.value and (one.fact in NAMES or one.fact in ("detector", "mask")):
            found[one.fact] = (*found.get(one.fact, ()), one.value)
    seen = [one.value for one in study.values.get("fov_deg", ()) if _is_seen(one.basis)]
    if "fov_deg" not in found and seen:
        found["fov_deg"] = tuple(seen)
    return found


def _is_seen(basis: str) -> bool:
    return basis not in ("inferred", "recalled")


def _alike(name: str, value: str, ours: float | str) -> bool:
    if isinstance(ours, str):
        return value == ours or (name == "detector" and {value, ours} <= _FOUR_CELLS)
    theirs = float(value)
    if name in ("faces", "subfields"):
        return theirs == ours
    return max(theirs, ours) <= FACTOR * min(theirs, ours) * (1.0 + 1e-9)


def _plain(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def identity(study: Study) -> Iterable[Departure]:
    """Give the departure of a key whose publication is not known."""
    if not study.title:
        text = "its title is not known, so neither sensor nor calibration can be compared"
        yield Departure("identity", study.key, text, "the publication that the key means", True)
    elif study.identity == "ambiguous":
        text = "which publication its key means is open"
        yield Departure("identity", study.key, text, "the publication that the key means", True)


def sensor(
    study: Study, facts: Facts, leading: Sequence[RunnablePipeline], sets: Mapping[str, DataSet]
) -> Iterable[Departure]:
    """Give the departures of the sensor that a study's leading pipelines are shown on."""
    if not leading:
        return
    shown = [_shown(one, sets) for one in leading]
    at, pair = min(shown, key=lambda one: len(differing(study, facts, *one)))
    if not at.design:
        return
    others = differing(study, facts, at, pair)
    if others:
        wanted = "; ".join(clause.partition(", here ")[0] for clause in others)
        text = f"{at.name} is another sensor ({'; '.join(others)})"
        yield Departure("sensor", at.name, text, f"a data set with {wanted}")
    missing, number = unknown_of_sensor(study, facts, at, pair)
    if len(missing) >= UNKNOWN_SHARE * number and missing:
        names = ", ".join(NAMES[name].partition(",")[0] for name in missing)
        text = f"{len(missing)} of {number} dimensions of its sensor are not known ({names})"
        yield Departure("sensor", DIMENSIONS, text, f"the study's {names}", True)


def parts(study: Study, facts: Facts) -> Iterable[Departure]:
    """Give the departures of parts and steps that the study states and nothing here has."""
    for one in facts.run_facts.get(study.key, ()):
        if one.fact == "part":
            text = f"{one.value} is left out ({one.note})"
            yield Departure("sensor", one.value, text, f"a run with {one.value}")


def calibration(
    study: Study,
    facts: Facts,
    leading: Sequence[RunnablePipeline],
    sets: Mapping[str, DataSet],
    catalogue: Catalogue,
) -> Iterable[Departure]:
    """Give the departure of a run that comes by its constants in another way than the study."""
    how = facts.calibration(study.key)
    drawn = {one.model for one in leading if _is_drawn(one.model, catalogue)}
    if not how:
        text = "whether it calibrates the constants of its model is not known"
        yield Departure("calibration", "", text, "how the study comes by its constants", True)
    elif how == "in flight" and not all(_shown(one, sets)[0].flies for one in leading):
        text = "it calibrates in flight, and its run is calibrated on a bench"
        yield Departure("calibration", how, text, "a data set of its sensor in orbit")
    elif (how == DRAWN) != bool(drawn) and (how == DRAWN or len(drawn) == len(leading)):
        text = f"its constants are {_HOW[how]}, and those of its run {_HOW[_OTHER[how]]}"
        yield Departure("calibration", how, text, f"a run whose constants are {_HOW[how]}")


_HOW = {"fitted": "fitted", "in flight": "fitted", DRAWN: "its drawing's"}
_OTHER = {"fitted": DRAWN, "in flight": DRAWN, DRAWN: "fitted"}


def _is_drawn(name: str, catalogue: Catalogue) -> bool:
    """Say whether the last stage of a model learns nothing from calibration samples."""
    from algorithms.calibration.drawn import DrawnModel  # noqa: PLC0415 - loads NumPy
    from algorithms.chain import Chain  # noqa: PLC0415 - likewise

    scored = catalogue.models[name]
    last = scored.stages[-1] if isinstance(scored, Chain) else scored
    return isinstance(last, type) and issubclass(last, DrawnModel)


def own_error(leading: Sequence[RunnablePipeline], scores: Scores) -> float | None:
    """Return the least own error of the leading pipelines where each is shown, degrees."""
    found = []
    for one in leading:
        at = one.settings[0]
        error = scores.get((at.dataset, at.condition, one.extractor, one.model))
        found += [error] if error is not None else []
    return min(found, default=None)


def score(
    study: Study, facts: Facts, leading: Sequence[RunnablePipeline], scores: Scores
) -> Iterable[Departure]:
    """Give the departure of an error far from the accuracy that the study reports, or of none."""
    error, reported = own_error(leading, scores), study.report("accuracy")
    if error is None:
        text = "its run has no score"
        yield Departure("score", "", text, "a data set on which its methods give directions")
    elif reported is not None and reason_for_score(study, facts) == "":
        times = error / reported.rms_deg
        if not 1.0 / SCORE_FACTOR <= times <= SCORE_FACTOR:
            text = (
                f"its own error of {error:.2g} deg here is {times:.2g} times the reported "
                f"{reported.rms_deg:.2g} deg ({reported.label}, as RMS)"
            )
            settled = "a reason for the difference, or the sensor and bench of the study"
            yield Departure("score", f"{times:.2g}", text, settled)


def reason_for_score(study: Study, facts: Facts) -> str:
    """Return why a score may be far from what the study reports; empty for no reason."""
    known = facts.run_facts.get(study.key, ())
    return next((one.value for one in known if one.fact == "reason"), "")


def _shown(one: RunnablePipeline, sets: Mapping[str, DataSet]) -> tuple[DataSet, tuple[str, str]]:
    name = one.settings[0].dataset
    return sets.get(name, DataSet(name)), (one.detector, one.mask)
