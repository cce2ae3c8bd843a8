"""The survey's assessment of its methods beside what was measured, property by property.

Definitions and limits stand in `benchmark.assessment.definitions`; the numbers come from stored
results alone (sweeps, scores and running times), so that asking measures nothing.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from algorithms.contract import Extractor
from algorithms.discovery import discover_extractors
from benchmark.assessment.definitions import DEFINITIONS, Definition
from benchmark.assessment.measures import SCORED, SWEPT, NotMeasuredError, Quantity, Row, Values
from benchmark.metrics.separation import store
from benchmark.results.store import PUBLISHED, Store
from benchmark.results.times import Place, Time
from benchmark.sweeps.record import swept
from survey_data.tables import load

if TYPE_CHECKING:
    import pandas as pd

#: How far survey and measurement are apart, from the difference of their scores.
AGREEMENTS = ("agrees", "near", "opposed")
#: What is measured cannot contradict the survey's score, whatever it says.
NOT_JUDGED = "not judged"
#: It could, but there is no measurement.
NOT_MEASURED = "not measured"
#: Every verdict there is, in the order of the tables.
VERDICTS = (*AGREEMENTS, NOT_JUDGED, NOT_MEASURED)


@dataclass(frozen=True)
class PropertyVerdict:
    """One property of one method.

    Survey and measurement score 2, 1 or 0; `measured` is None where it is not judged or not
    measured, `value` also where nothing was found: `reason` says why. `judged`: the definition lets
    this survey's score be contradicted.
    """

    name: str
    survey: int
    measured: int | None
    value: float | None
    extractor: str
    series: str
    reason: str
    judged: bool = True

    @property
    def agreement(self) -> str:
        """`agrees`, `near` (one apart), `opposed` (two apart), `not judged`, `not measured`."""
        if not self.judged:
            return NOT_JUDGED
        if self.measured is None:
            return NOT_MEASURED
        return AGREEMENTS[abs(self.survey - self.measured)]


@dataclass(frozen=True)
class MethodAssessment:
    """One method with its verdicts, in the order of the survey's table."""

    method: str
    taxonomy: str
    case_study: str
    extractors: tuple[str, ...]
    verdicts: tuple[PropertyVerdict, ...]

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of properties by agreement."""
        found = Counter(verdict.agreement for verdict in self.verdicts)
        return {name: found[name] for name in VERDICTS}


def assess(
    directory: Path | str = PUBLISHED,
    extractors: Mapping[str, type[Extractor]] | None = None,
    times: Mapping[Place, Time] | None = None,
    scores: Sequence[Row] | None = None,
) -> list[MethodAssessment]:
    """Assess every method of the survey's table from published results.

    `scores` are those of the standard unit, where they have been read already. StoreError,
    ComponentsError when a stored file cannot be read.
    """
    known = discover_extractors() if extractors is None else extractors
    store = Store(directory)
    rows: Sequence[Row] = store.rows() if scores is None else scores
    evidence = _Evidence(swept(store.directory), rows, list((times or {}).values()))
    tables = load()
    table = tables.feature_assessment
    methods = list(dict.fromkeys(zip(table["extractor"], table["case_study"], strict=True)))
    taxonomy = {name: _taxonomy(name, tables.aliases) for name, _ in methods}
    found = []
    for method, study in methods:
        shared = sum(value == taxonomy[method] for value in taxonomy.values()) > 1
        names = _implementations(known, taxonomy[method], study if shared else None)
        said = table[table["extractor"] == method].set_index("property")["score"]
        verdicts = tuple(
            _verdict(definition, int(said[name]), names, evidence)
            for name, definition in DEFINITIONS.items()
        )
        found.append(MethodAssessment(method, taxonomy[method], study, tuple(names), verdicts))
    return found


def document(assessed: Iterable[MethodAssessment]) -> dict[str, Any]:
    """Return definitions, methods with their verdicts, and totals, of what JSON knows."""
    listed = list(assessed)
    return {
        "definitions": [
            {
                "property": definition.name,
                "source": definition.source,
                "measure": definition.measure,
                "limits": definition.limits(),
                "judged": definition.judged,
                "why": definition.why,
            }
            for definition in DEFINITIONS.values()
        ],
        "methods": [
            {
                "method": one.method,
                "taxonomy": one.taxonomy,
                "case_study": one.case_study,
                "extractors": list(one.extractors),
                "counts": dict(one.counts),
                "properties": [_show(verdict) for verdict in one.verdicts],
            }
            for one in listed
        ],
        "totals": totals_of(listed),
    }


def _show(verdict: PropertyVerdict) -> dict[str, Any]:
    return {
        "property": verdict.name,
        "survey": verdict.survey,
        "measured": verdict.measured,
        "agreement": verdict.agreement,
        "value": verdict.value,
        "unit": DEFINITIONS[verdict.name].unit,
        "extractor": verdict.extractor,
        "measured_on": verdict.series,
        "reason": verdict.reason,
    }


def totals_of(assessed: Iterable[MethodAssessment]) -> dict[str, int]:
    """Return the number of verdicts by agreement."""
    found: Counter[str] = Counter()
    for one in assessed:
        found.update(one.counts)
    return {name: found[name] for name in VERDICTS}


@dataclass(frozen=True)
class _Evidence:
    swept: Sequence[Row]
    scores: Sequence[Row]
    times: Sequence[Time]


def _verdict(
    definition: Definition, survey: int, names: Sequence[str], evidence: _Evidence
) -> PropertyVerdict:
    """Take the best of a method's implementations, of all series each is measured on."""
    best, name, missing = _best(definition, names, evidence)
    measured = definition.score(best.value) if best else None
    undecided = definition.why_undecided(survey, measured)
    return PropertyVerdict(
        definition.name,
        survey,
        None if undecided else measured,
        store(best.value) if best else None,
        name,
        best.where if best else "",
        undecided or (best.why if best else missing),
        judged=not undecided,
    )


def _best(
    definition: Definition, names: Sequence[str], evidence: _Evidence
) -> tuple[Quantity | None, str, str]:
    """Return the best quantity and whose it is, or None and why there is none."""
    if not definition.has_experiment or not names:
        return None, "", "not implemented"
    found: list[tuple[Quantity, str]] = []
    reasons = []
    for name in names:
        try:
            found += [(quantity, name) for quantity in _values(definition, name, evidence)]
        except NotMeasuredError as reason:
            reasons.append(str(reason))
    if not found:
        return None, "", "; ".join(dict.fromkeys(reasons))
    sign = -1.0 if definition.larger_is_better else 1.0

    def order(one: tuple[Quantity, str]) -> tuple[float, str, str]:
        (value, where, _), name = one
        return (math.inf if math.isnan(value) else sign * value, name, where)

    quantity, name = min(found, key=order)
    if math.isnan(quantity.value) and len(found) > 1:  # none is the best: say what each lacks
        why = "; ".join(f"{name} on {where}: {why}" for (_, where, why), name in found)
        quantity = quantity._replace(why=why)
    return quantity, name, ""


def _values(definition: Definition, name: str, evidence: _Evidence) -> Values:
    """Return the quantities of an implementation; NaN where it does not do it at all."""
    if definition.source == "sweeps":
        rows = [row for row in evidence.swept if row["extractor"] == name]
        return SWEPT[definition.name](rows)
    if definition.source == "scores":
        rows = [row for row in evidence.scores if row["extractor"] == name]
        return SCORED[definition.name](rows)
    return _cost([time for time in evidence.times if time.extractor == name])


def _cost(times: Sequence[Time]) -> Values:
    """Return the median ratio of extraction to the reference over the data sets with a time."""
    ratios = {time.dataset: time.extract_ratio for time in times if time.extract_ratio is not None}
    if not ratios:
        raise NotMeasuredError("not timed: `sunatlas leaderboard times`")
    return [Quantity(median(ratios.values()), f"{len(ratios)} data sets")]


def _taxonomy(method: str, aliases: pd.DataFrame) -> str:
    known = aliases[(aliases["attribute"] == "extractor") & (aliases["alias"] == method)]
    return str(known["value"].iloc[0]) if len(known) else method


def _implementations(
    known: Mapping[str, type[Extractor]], taxonomy: str, study: str | None
) -> list[str]:
    """Names of the survey's own implementations of a method; of a study, where methods share."""
    return sorted(
        name
        for name, extractor in known.items()
        if extractor.about.taxonomy == taxonomy
        and extractor.about.origin == "survey"
        and (study is None or study in extractor.about.studies)
    )
