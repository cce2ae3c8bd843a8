"""What each generated part of the docs says, as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import survey_data
from api.docs.examples import command_line, http_examples
from api.docs.knowledge import knowledge
from api.docs.markdown import table as _table
from api.service import studies as service
from benchmark.datasets import coverage as simulated
from benchmark.datasets import study_names
from registry.fidelity.evidence import FACTOR, SCORE_FACTOR, UNKNOWN_SHARE
from registry.fidelity.grading import tally_text
from registry.fidelity.purposes import PURPOSES
from registry.fidelity.runnable import ESSENTIAL
from registry.resolution import Resolution
from registry.sensors import BASES
from registry.taxonomy import NO_IMPLEMENTATION_STATED, NOT_IN_SURVEY
from survey_data import labels

#: Values of a finding whose counts are printed.
_COUNTS_SHOWN = 4

__all__ = [
    "command_line",
    "coverage",
    "datasets",
    "extractors",
    "findings",
    "http_examples",
    "missing_implementations",
    "resolutions",
    "study_sensors",
]


def extractors() -> str:
    """List every extractor: what it implements, what it reads and gives."""
    rows = [
        (
            f"`{i.name}`",
            i.title,
            NOT_IN_SURVEY if i.taxonomy == NO_IMPLEMENTATION_STATED else i.taxonomy,
            i.summary,
            f"{i.observation} → {i.kind}",
            ", ".join(i.studies),
        )
        for i in knowledge().catalogue.implementations("extractor")
    ]
    return _table(
        ("identifier", "name", "taxonomy", "what it does", "reads → gives", "studies"), rows
    )


def missing_implementations() -> str:
    """List the taxonomy's values that nothing implements, with the studies that wait for them."""
    known = knowledge()
    rows = []
    for attribute, value in known.catalogue.gaps():
        waiting = [key for key, s in known.facts.studies.items() if value in s.of(attribute)]
        name = known.taxonomy.name(attribute, value)
        rows.append((attribute, value, name, str(len(waiting))))
    if not rows:
        return "Every value of the taxonomy is implemented."
    rows.sort(key=lambda row: (row[0], -int(row[3]), row[1]))
    return _table(("attribute", "value", "name", "studies"), rows)


def datasets() -> str:
    """List the data sets in a table, then describe each, with the bound of each condition."""
    cards = knowledge().measurements.cards
    rows = [
        (
            f"[{card['name']}](#{card['name']})",
            card["detector"],
            card["mask"],
            str(card["observation"]),
            str(card["version"]),
            ", ".join(card["follows"]),
        )
        for card in cards
    ]
    head = ("data set", "detector", "mask", "readings", "version", "based on")
    return "\n\n".join((_table(head, rows), *map(_card, cards)))


def study_sensors() -> str:
    """Describe the sensors of single studies, with the bound of each condition."""
    measured = knowledge().measurements
    return "\n\n".join(_card(measured.card(name)) for name in study_names())


def coverage() -> str:
    """Say which detector-mask pairs of the mapped studies are simulated."""
    found = simulated.coverage()
    rows = [
        (
            pair.detector,
            pair.mask,
            str(len(pair.studies)),
            ", ".join(f"[{name}](#{name})" for name in pair.datasets) or pair.reason,
        )
        for pair in found.pairs
    ]
    return f"{found.sentence()}\n\n" + _table(
        ("detector", "mask", "studies", "data sets, or why none"), rows
    )


def findings() -> str:
    """List the survey's findings with the verdict of the tables."""
    report = survey_data.fidelity(survey_data.load())
    counted = ", ".join(f"{count} {verdict}" for verdict, count in report.verdicts.items())
    rows = [
        (
            finding.id if clause.clause == 1 else "",
            clause.verdict,
            finding.statement if clause.clause == 1 else "",
            _rank(clause.ranking),
            "" if clause.verdict == "reproduced" else clause.settled_by,
        )
        for finding in report.findings
        for clause in finding.clauses
    ]
    untested = [f"{f.id}, {f.not_tested}" for f in report.findings if f.not_tested]
    return (
        f"{report.studies} studies; the survey states {report.stated}. {report.explanation}\n\n"
        f"{len(report.findings)} findings: {counted}. A finding of several clauses has a row for "
        "each.\n\n"
        + _table(("id", "verdict", "finding", "counts", "what settles it"), rows)
        + f"\n\nNot tested: {'; '.join(untested)}."
    )


def resolutions() -> str:
    """Say how the studies run: on what evidence, by what rules, and what does not run as it is."""
    known = knowledge()
    resolved = known.resolutions
    cells = sum(len(p.settings) for found in resolved.values() for p in found.pipelines)
    compared = service.compare_accuracy(known)
    counted = (
        f"Runs of {len(resolved)} studies: "
        f"{tally_text(found.fidelity.grade for found in resolved.values())}. They are shown on "
        f"{cells} cells (a pipeline on a data set under a condition)."
    )
    return "\n\n".join(
        (
            counted,
            RULES,
            "What differs of runs that are close or a stand-in, and what would raise them:",
            _table(("study", "grade", "differs", "raised by"), _differences(resolved)),
            "What is unknown and keeps runs from being faithful:",
            _table(("part", "unknown", "studies"), _unknown(resolved)),
            "Reported accuracy against the own error of the run, worst first. "
            + service.say_comparison(compared),
            _table(
                (
                    "study",
                    "grade",
                    "reported, deg",
                    "kind",
                    "RMS, deg",
                    "here, deg",
                    "times",
                    "why",
                ),
                (_compared(row) for row in compared),
            ),
            "What studies are run for, by the rules of `survey_data/purposes.csv`:",
            _table(("purpose", "rule", "studies"), _by_purpose(resolved)),
            "What the parts of a pipeline rest on, by studies (of several, that of most evidence):",
            _table(("part", *BASES), _by_basis(resolved)),
        )
    )


RULES = (
    "A part of a run departs from the study where it differs, or where what it would have to be "
    "compared with is unknown. It differs where a stated sensor is missing or the run stands on "
    "another one: another detector or mask, another arrangement or number of faces or openings, a "
    f"dimension further off than a factor of {FACTOR:g}, a stated part left out; where no data "
    "set of the sensor shows what the study is run for; where a stated extractor, model or "
    "compensation does not run, or only as another variant; where the study calibrates and the "
    "run does not, or in flight and the run on a bench; and where the own error is further off "
    f"the accuracy that it reports than a factor of {SCORE_FACTOR:g}, without a reason in "
    "`survey_data/run_facts.csv`. It is unknown where the title, the extractor, the model or the "
    "way to its constants is not known, the sensor is recalled or chosen, or "
    f"{UNKNOWN_SHARE:.0%} or more of the facts that its kind of sensor has are not known. Nothing "
    "that departs is faithful, unknown parts alone assumed, one that differs close, more a "
    "stand-in."
)


def _differences(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """List what differs of each run, those of which most differs first."""
    found = {
        key: [one for one in resolution.fidelity.departures if not one.unknown]
        for key, resolution in resolved.items()
    }
    for key in sorted(found, key=lambda key: (-len(found[key]), key)):
        for at, one in enumerate(found[key]):
            first = (key, resolved[key].fidelity.grade) if at == 0 else ("", "")
            yield *first, one.text, one.settled_by


def _unknown(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """Count what is unknown by part and what would settle it, the most studies first."""
    studies: dict[tuple[str, str], set[str]] = {}
    for key, found in resolved.items():
        for one in found.fidelity.departures:
            if one.unknown:
                says = "dimensions" if one.value == "dimensions" else one.settled_by
                studies.setdefault((one.part, says), set()).add(key)
    for (part, says), keys in sorted(studies.items(), key=lambda item: (-len(item[1]), item[0])):
        yield part, says, str(len(keys))


def _compared(row: Mapping[str, Any]) -> Sequence[str]:
    """Write a row of reported and own error."""
    numbers = (f"{row[name]:.3g}" for name in ("rms_deg", "own_deg", "times"))
    return (
        *(row["key"], row["grade"], f"{row['reported_deg']:g}", row["kind"]),
        *(*numbers, row["reason"]),
    )


def _by_purpose(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """List the purposes with the rule and the studies of each."""
    studies: dict[tuple[str, str], list[str]] = {}
    for key, found in resolved.items():
        for purpose, rule in found.fidelity.purposes.items():
            studies.setdefault((PURPOSES[purpose], rule), []).append(key)
    for (shown, rule), keys in sorted(studies.items(), key=lambda item: item[0][1]):
        yield shown, rule, ", ".join(keys)


def _by_basis(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """Count the studies by what each part of their best pipeline rests on."""
    best = [found.best_pipeline for found in resolved.values() if found.best_pipeline is not None]
    for part in ESSENTIAL:
        counted = Counter(pipeline.basis[part] for pipeline in best)
        yield part, *(str(counted[basis]) for basis in BASES)
    weakest = Counter(max(p.basis.values(), key=BASES.index) for p in best)
    yield "the weakest of them", *(str(weakest[basis]) for basis in BASES)


def _rank(ranking: Sequence[tuple[str, int]]) -> str:
    """Write the counts of a finding, the rarest of many left out."""
    shown = ", ".join(f"{value} {count}" for value, count in ranking[:_COUNTS_SHOWN])
    more = len(ranking) - _COUNTS_SHOWN
    return f"{shown} and {more} rarer" if more > 0 else shown


def _card(card: Any) -> str:
    bounds = "; ".join(f"{name} {_number(card['bounds'].get(name))}" for name in card["setups"])
    return (
        f"### {card['name']}\n\n"
        f"{labels.label_of(card['description'])}\n\n"
        f"Bounds (RMS, deg): {bounds}."
    )


def _number(value: float | None) -> str:
    return "not measured" if value is None else f"{value:.3g}"
