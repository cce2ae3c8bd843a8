"""The findings' verdicts against a second implementation, and each kind on made-up studies."""

from __future__ import annotations

import csv
from collections import defaultdict
from typing import Any

import pandas as pd
import pytest

import survey_data
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.findings.checks import (
    KINDS,
    FindingSyntaxError,
    Vocabulary,
    evaluate,
    parse_finding,
    study_values,
)


def rows_of(table: str) -> list[dict[str, str]]:
    with (DATA_DIRECTORY / f"{table}.csv").open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def studies_having() -> dict[tuple[str, str], set[str]]:
    """(attribute, value) -> studies, straight from the files."""
    category = {(r["attribute"], r["value"]): r["category"] for r in rows_of("taxonomy")}
    derived = {"model": "model_category", "extractor": "extractor_family"}
    having: dict[tuple[str, str], set[str]] = defaultdict(set)
    for r in rows_of("attributes"):
        if r["value"]:
            having[r["attribute"], r["value"]].add(r["study"])
        if r["attribute"] in derived:
            family = category[r["attribute"], r["value"]]
            having[derived[r["attribute"]], family].add(r["study"])
    for r in rows_of("studies"):
        having["year", r["year"]].add(r["key"])
    for (a, detector), left in list(having.items()):
        for (b, mask), right in list(having.items()):
            if (a, b) == ("detector", "mask") and left & right:
                having["detector+mask", f"{detector}+{mask}"] = left & right
    return having


def judge_by_brute_force(row: dict[str, str]) -> tuple[str, dict[str, int]]:
    """Verdict and counts by sets of studies, one per value."""
    having = studies_having()
    chosen = {r["key"] for r in rows_of("studies")}
    for condition in filter(None, row["given"].split("&")):
        attribute, value = condition.split("=")
        allowed = set(having[attribute, value])
        if condition == "detector=PD":
            allowed |= having["detector", "QPD"]
        chosen &= allowed
    ranked, listed = row["expects"].split(": ")
    named = listed.replace(">", "|").split("|")
    sets = {value: studies & chosen for (name, value), studies in having.items() if name == ranked}
    counted = len(set().union(*sets.values()))
    counts = {value: len(studies) for value, studies in sets.items() if studies}
    if row["kind"] == "top-centroid":
        others = ("Direct", "Voltage balance", "Linear-phase", "Eigen-analysis", "None")
        counts = {value: count for value, count in counts.items() if value not in others}
    if counted < 3:
        return "undecidable", counts
    got = [counts.get(value, 0) for value in named]
    falling = sorted(counts.values(), reverse=True)
    others = [n for value, n in counts.items() if value not in named]
    first_n = falling[: max(2, len(named))]
    holds = {
        "top": max(got) == falling[0],
        "top-centroid": max(got) == falling[0],
        "top-set": len([n for n in got if n >= first_n[-1]]) >= len(named) - 1,
        "order": got == sorted(set(got), reverse=True) and got[0] == falling[0],
        "bottom": all(n >= max(got) for n in others),
        "bottom-set": all(n >= max(got) for n in others),
        "among": min(got) > 0,
        "spread": len([n for n in got if n]) >= 3,
    }
    return ("reproduced" if holds[row["kind"]] else "contradicted"), counts


def test_every_verdict_and_every_count_agrees_with_brute_force(
    tables: survey_data.SurveyTables,
) -> None:
    verdicts = survey_data.fidelity(tables).findings
    rows = rows_of("findings")
    assert [verdict.id for verdict in verdicts] == [f"F{n:02d}" for n in range(1, 52)]
    for row, verdict in zip(rows, verdicts, strict=True):
        expected, counts = judge_by_brute_force(row)
        assert (verdict.id, verdict.verdict) == (row["id"], expected)
        assert dict(verdict.ranking) == counts, row["id"]
        falling = [count for _, count in verdict.ranking]
        assert falling == sorted(falling, reverse=True)


def test_39_findings_are_reproduced_9_contradicted_and_3_undecidable(
    tables: survey_data.SurveyTables,
) -> None:
    report = survey_data.fidelity(tables)
    assert report.verdicts == {"reproduced": 39, "contradicted": 9, "undecidable": 3}
    by_verdict = defaultdict(set)
    for finding in report.findings:
        by_verdict[finding.verdict].add(finding.id)
    assert by_verdict["undecidable"] == {"F18", "F31", "F32"}
    assert by_verdict["contradicted"] == {
        "F02", "F03", "F04", "F13", "F22", "F27", "F30", "F40", "F44",
    }  # fmt: skip


# Made-up studies: errors A > B > C = D, four masks, two extractors.
TAXONOMY = pd.DataFrame(
    [("error", v, v, "Goal") for v in "ABCDE"]
    + [("extractor", v, v, "Centroid detection") for v in ("X", "Y")]
    + [("extractor", "Z", "Z", "Other")]
    + [("detector", v, v, "Analog") for v in ("PD", "QPD", "CMOS")]
    + [("mask", v, v, "Mask") for v in ("m", "n")]
    + [("model", v, v, c) for v, c in (("p", "P"), ("q", "P"), ("r", "R"))],
    columns=["attribute", "value", "name", "category"],
)
STUDIES = {
    "s1": {"error": "AB", "extractor": ["Z", "X"], "detector": ["PD"], "mask": "m", "model": "pq"},
    "s2": {"error": "AC", "extractor": ["Z", "X"], "detector": ["QPD"], "mask": "m", "model": "r"},
    "s3": {"error": "ABD", "extractor": ["Z", "Y"], "detector": ["CMOS"], "mask": "n"},
    "s4": {"error": "A", "extractor": ["Z"], "detector": ["PD", "CMOS"], "mask": "mn"},
}


def made_up(given: str | None, expects: str, kind: str) -> Any:
    vocabulary = Vocabulary(TAXONOMY)
    studies = pd.DataFrame({"key": list(STUDIES), "year": [2001, 2002, 2002, 2003]})
    cells = [(s, a, v) for s, entry in STUDIES.items() for a, vs in entry.items() for v in vs]
    attributes = pd.DataFrame(cells, columns=["study", "attribute", "value"])
    values = study_values(studies, attributes, vocabulary)
    row = {
        "id": "F01", "survey_section": "sec:x", "statement": "made up",
        "given": given, "expects": expects, "kind": kind,
    }  # fmt: skip
    return evaluate(parse_finding(row, vocabulary), row, values, vocabulary)


@pytest.mark.parametrize(
    ("kind", "expects", "holds"),
    [
        ("top", "error: A", True),
        ("top", "error: B|A", True),
        ("top", "error: B", False),
        ("top-set", "error: A|B", True),
        ("top-set", "error: A|D", True),  # all but at most one
        ("top-set", "error: C|D", False),
        ("top-set", "error: B|C|E", True),  # ties with the third place count
        ("top-set", "error: C|E", False),
        ("top-set", "error: E", True),  # one named: all but at most one is none
        ("order", "error: A>B>C", True),
        ("order", "error: A>C>D", False),  # C and D are tied
        ("order", "error: B>C", False),  # B is not the most frequent
        ("bottom", "error: C", True),
        ("bottom", "error: B", False),
        ("bottom-set", "error: C|D", True),
        ("bottom-set", "error: B|C", False),
        ("bottom", "error: E", True),  # occurs nowhere: nothing is rarer
        ("among", "error: D|C", True),
        ("among", "error: A|E", False),
        ("spread", "error: A|B|E", False),
        ("spread", "error: A|B|C|E", True),
        ("top", "extractor: X", False),  # Z is in every study
        ("top-centroid", "extractor: X", True),
        ("top-centroid", "extractor: Y", False),
        ("top", "detector+mask: PD+m", True),
        ("among", "detector+mask: QPD+n", False),  # never in one study
        ("order", "year: 2002>2001", True),
    ],
)
def test_each_kind_means_what_it_says(kind: str, expects: str, holds: bool) -> None:
    verdict = made_up(None, expects, kind)
    assert verdict.verdict == ("reproduced" if holds else "contradicted")
    assert verdict.matching == verdict.counted == 4


def test_every_kind_was_tried() -> None:
    marks = test_each_kind_means_what_it_says.pytestmark
    assert {case[0] for case in marks[0].args[1]} == set(KINDS)


def test_a_study_counts_once_for_a_category_it_has_two_values_of() -> None:
    verdict = made_up(None, "model_category: P", "top")
    assert verdict.ranking == (("P", 1), ("R", 1))
    assert verdict.tied
    assert verdict.verdict == "undecidable"  # two studies with a known model


def test_a_photodiode_filter_includes_quadrant_photodiodes() -> None:
    verdict = made_up("detector=PD", "error: A", "top")
    assert (verdict.matching, verdict.counted) == (3, 3)
    assert made_up("detector=QPD", "error: A", "top").matching == 1


def test_conditions_are_joined_by_and() -> None:
    verdict = made_up("error=B&mask=n", "error: A", "top")
    assert verdict.matching == 1
    assert verdict.verdict == "undecidable"


@pytest.mark.parametrize(
    ("given", "expects", "kind", "column"),
    [
        ("error=", "error: A", "top", "given"),
        ("sundial=A", "error: A", "top", "given"),
        (None, "error:A", "top", "expects"),
        (None, "error: ", "top", "expects"),
        (None, "error: A|B", "order", "expects"),
        (None, "error: A", "topmost", "kind"),
    ],
)
def test_a_finding_out_of_grammar_is_refused(
    given: str | None, expects: str, kind: str, column: str
) -> None:
    with pytest.raises(FindingSyntaxError) as caught:
        made_up(given, expects, kind)
    assert caught.value.column == column
