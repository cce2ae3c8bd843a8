"""What each generated part of the docs says, as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import survey_data
from api.docs.examples import command_line, http_examples
from api.docs.knowledge import knowledge
from api.docs.markdown import table as _table
from benchmark.datasets import coverage as simulated
from registry.resolution import ESSENTIAL, Resolution
from registry.sensors import BASES

#: Values of a finding whose counts are printed.
_COUNTS_SHOWN = 8

__all__ = [
    "command_line",
    "coverage",
    "datasets",
    "extractors",
    "findings",
    "http_examples",
    "missing",
    "models",
    "resolutions",
]


def extractors() -> str:
    """List every extractor: what it implements, what it reads and gives."""
    rows = [
        (
            f"`{i.name}`",
            i.taxonomy,
            i.summary,
            f"{i.observation} → {i.kind}",
            ", ".join(i.studies),
            _labels(i.labels),
        )
        for i in knowledge().catalogue.listing("extractor")
    ]
    return _table(("name", "taxonomy", "what it does", "reads → gives", "studies", "survey"), rows)


def models() -> str:
    """List every model: what it implements, what it reads."""
    rows = [
        (
            f"`{i.name}`",
            i.taxonomy,
            i.summary,
            ", ".join(i.accepts or ()),
            ", ".join(i.studies),
            _labels(i.labels),
        )
        for i in knowledge().catalogue.listing("model")
    ]
    return _table(("name", "taxonomy", "what it does", "reads", "studies", "survey"), rows)


def missing() -> str:
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
    """Write a card for each standard data set, with the published bounds."""
    return "\n\n".join(_card(card) for card in knowledge().measurements.cards)


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
            finding.verdict if clause.clause == 1 else "",
            finding.statement if clause.clause == 1 else "",
            f"{clause.given or 'all studies'} → {clause.expects} ({clause.kind})",
            clause.verdict,
            _ranked(clause.ranking),
            clause.settled_by,
        )
        for finding in report.findings
        for clause in finding.clauses
    ]
    untested = [f"{f.id}, {f.not_tested}" for f in report.findings if f.not_tested]
    return (
        f"{report.studies} studies; the survey states {report.stated}. {report.explanation}\n\n"
        f"{len(report.findings)} findings: {counted}. A finding of several clauses has a row for "
        "each.\n\n"
        + _table(
            ("id", "verdict", "finding", "expects", "clause", "counts", "what settles it"), rows
        )
        + f"\n\nNot tested: {'; '.join(untested)}."
    )


def resolutions() -> str:
    """Say how the studies run: on what evidence, by what rules, and what does not run as it is."""
    known = knowledge()
    resolved = known.resolutions
    states = Counter(resolution.state for resolution in resolved.values())
    cells = sum(len(p.datasets) for found in resolved.values() for p in found.pipelines)
    counted = (
        f"Of {len(resolved)} studies {states['complete']} run with every value of their mapping, "
        f"{states['partial']} in part, {states['none']} not at all. They have {cells} cells (a "
        "pipeline on a data set)."
    )
    lines = [
        counted,
        "What the parts of a pipeline rest on, by studies (of several, that of most evidence):",
        _table(("part", *BASES), _by_basis(resolved)),
        "By what rules empty cells are filled, and methods stand in for others:",
        _table(("part", "rule", "studies"), _by_rule(resolved)),
    ]
    waiting: Counter[tuple[str, str, str]] = Counter(
        gap
        for resolution in resolved.values()
        for gap in {(g.attribute, g.value, g.reason) for g in resolution.gaps if g.value}
    )
    rows = [
        (attribute, value, reason, str(count))
        for (attribute, value, reason), count in sorted(
            waiting.items(), key=lambda item: (-item[1], item[0])
        )
    ]
    if rows:
        lines.append("What does not run as the mapping states it, by the number of studies:")
        lines.append(_table(("attribute", "value", "reason", "studies"), rows))
    return "\n\n".join(lines)


def _by_basis(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """Count the studies by what each part of their best pipeline rests on."""
    best = [found.best for found in resolved.values() if found.best is not None]
    for part in ESSENTIAL:
        counted = Counter(pipeline.basis[part] for pipeline in best)
        yield part, *(str(counted[basis]) for basis in BASES)
    weakest = Counter(max(p.basis.values(), key=BASES.index) for p in best)
    yield "the weakest of them", *(str(weakest[basis]) for basis in BASES)


def _by_rule(resolved: Mapping[str, Resolution]) -> Iterable[Sequence[str]]:
    """List the rules that fill something in, with the studies they do it for."""
    found: dict[tuple[str, str], dict[str, None]] = {}
    for key, resolution in resolved.items():
        for pipeline in resolution.pipelines:
            for part in ESSENTIAL:
                if pipeline.basis[part] == "defaulted":
                    found.setdefault((part, pipeline.assumed[part]), {})[key] = None
    order = {part: at for at, part in enumerate(ESSENTIAL)}
    for (part, rule), keys in sorted(found.items(), key=lambda item: (order[item[0][0]], item[0])):
        yield part, rule, ", ".join(keys)


def _ranked(ranking: Sequence[tuple[str, int]]) -> str:
    """Write the counts of a finding, the rarest of many left out."""
    shown = ", ".join(f"{value} {count}" for value, count in ranking[:_COUNTS_SHOWN])
    more = len(ranking) - _COUNTS_SHOWN
    return f"{shown} and {more} rarer" if more > 0 else shown


def _card(card: Any) -> str:
    rows = [
        (condition, _number(card["bounds"].get(condition)), setup["description"])
        for condition, setup in card["setups"].items()
    ]
    follows = ", ".join(card["follows"]) or "no study"
    return (
        f"### {card['name']}\n\n"
        f"{card['description']}\n\n"
        f"Version {card['version']}; {card['detector']}, {card['mask']}; gives "
        f"{card['observation']}; follows {follows}.\n\n"
        + _table(("condition", "bound (rms, deg)", "what differs"), rows)
    )


def _labels(labels: Iterable[str]) -> str:
    return ", ".join(f"`{label}`" for label in labels)


def _number(value: float | None) -> str:
    return "not measured" if value is None else f"{value:.3g}"
