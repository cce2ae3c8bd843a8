"""Generated parts of the docs where the record lacks something: each says that it does."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from api.docs import (
    assessment,
    claim_pages,
    curves,
    examples,
    export,
    field_plots,
    front,
    limits,
    measured_facts,
    model_pages,
    parts,
)
from api.docs.field_plots import PlottedPipeline
from benchmark.claims.former import former_outcomes
from benchmark.claims.judgement import Judgement
from benchmark.claims.ledger import Entry
from benchmark.claims.review import reviews
from benchmark.claims.rules import Claim, Rule, claims
from survey_data.descriptor import DATA_DIRECTORY

RULE = Rule("one", "share of frames found", "linear", ">", 0.5, math.nan, timed=False)
HOLDS = Judgement(RULE, 0.75, 0.7, 0.8, 20, "holds")
FAILS = Judgement(RULE, 0.25, 0.2, 0.3, 20, "fails")


def entry(claim: Claim, **members: Any) -> Entry:
    """A claim that was not measured, but for the members given."""
    nothing: dict[str, Any] = {"verdict": None, "rules": (), "second": (), "outcome": None}
    read: dict[str, Any] = {"review": reviews()["C01"], "former": former_outcomes()["C02"]}
    return Entry(**{"claim": claim, "explanation": "", **read, **nothing, **members})


@pytest.fixture
def claim() -> Claim:
    return dataclasses.replace(next(iter(claims().values())), id="C99", second="a closed form")


def test_claims_are_told_with_and_without_measurements(
    claim: Claim, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = SimpleNamespace(lines={"one": None})
    unbounded = Judgement(RULE, math.nan, math.nan, 1.0, 20, "fails")
    none = Judgement(RULE, math.nan, math.nan, math.inf, 2, "fails")
    measured = {"rules": (HOLDS, unbounded, none), "verdict": "refuted", "outcome": drawn}
    told = [
        entry(dataclasses.replace(claim, id="C98")),
        entry(claim, **measured, second=(HOLDS,)),
        entry(claim, **measured, second=(FAILS,)),
    ]
    monkeypatch.setattr(claim_pages, "_entries", lambda: tuple(told))
    without, same, other = claim_pages.trials().split("### ")[1:]
    assert "**Not measured.**" in without
    assert "Second method" not in without
    assert "![" not in without
    line = "- share of frames found: {}; > 0.5: **{}**"
    for said in (same, other):
        assert line.format("0.75 [0.7, 0.8]", "holds") in said
        assert line.format("unbounded", "fails") in said
        assert line.format("none (2 trials)", "fails") in said
        assert f"![{claim.up} against {claim.across}](" in said
    assert "Second method, a closed form: the same numbers." in same
    assert line.format("0.25 [0.2, 0.3]", "fails") not in same
    assert line.format("0.25 [0.2, 0.3]", "fails") in other
    for said in (without, same, other):
        assert f"> {reviews()['C01'].quotation} (line {reviews()['C01'].line})" in said
        assert said.count("Before a change, measured on ") == 2
        assert ": 1.002 [1.001, 1.003]; > 1: **holds**" in said
    assert "**3 claims: " in claim_pages.counts()
    assert "2 were checked by a second method ([C99](#c99), [C99](#c99))" in claim_pages.counts()
    assert "- **not measured**: [C98](#c98)" in claim_pages.verdicts()


def test_a_claim_of_the_guide_that_is_not_reproduced_any_more_stops_it(
    claim: Claim, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ledger() -> list[Entry]:
        return [
            entry(dataclasses.replace(claim, id=name), verdict=verdicts[name], rules=(HOLDS,))
            for name in measured_facts.USEFUL
        ]

    verdicts = dict.fromkeys(measured_facts.USEFUL, "reproduced")
    monkeypatch.setattr(measured_facts, "ledger", ledger)
    assert measured_facts.reproduced_claims().count("0.75 [0.7, 0.8]") == len(verdicts)
    changed = measured_facts.USEFUL[2]
    verdicts[changed] = "refuted"
    with pytest.raises(ValueError, match=f"^{changed}: not reproduced any more"):
        measured_facts.reproduced_claims()


def test_values_that_nothing_implements_are_listed_with_the_studies_that_wait(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gaps = [("model", "Slit"), ("model", "Spline"), ("extractor", "CNN")]
    studies = {
        "A2001": SimpleNamespace(of=lambda attribute: ["Spline"] if attribute == "model" else []),
        "B2002": SimpleNamespace(of=lambda attribute: ["CNN"] if attribute == "extractor" else []),
    }
    known = SimpleNamespace(
        catalogue=SimpleNamespace(gaps=lambda: gaps),
        facts=SimpleNamespace(studies=studies),
        taxonomy=SimpleNamespace(name=lambda _attribute, value: f"{value} in full"),
    )
    monkeypatch.setattr(parts, "knowledge", lambda: known)
    lines = parts.missing_implementations().splitlines()[2:]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    assert rows == [
        ["extractor", "CNN", "CNN in full", "1"],
        ["model", "Spline", "Spline in full", "1"],
        ["model", "Slit", "Slit in full", "0"],
    ]
    gaps.clear()
    assert parts.missing_implementations() == "Every value of the taxonomy is implemented."


def test_a_condition_without_a_bound_is_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    card = dict.fromkeys(("detector", "mask", "observation", "version", "description"), "x")
    card |= {"name": "one", "follows": [], "setups": ["nominal", "noise"]}  # type: ignore[dict-item]
    known = SimpleNamespace(
        measurements=SimpleNamespace(cards=[{**card, "bounds": {"nominal": 0.01234}}])
    )
    monkeypatch.setattr(parts, "knowledge", lambda: known)
    assert parts.datasets().endswith("Bounds (RMS, deg): nominal 0.0123; noise not measured.")


@pytest.fixture
def board(monkeypatch: pytest.MonkeyPatch) -> list[Mapping[str, Any]]:
    """Rows of a leaderboard that a test fills, behind a category of two models and a chain."""
    rows: list[Mapping[str, Any]] = []
    names = ("a", "b", "optical + a")
    monkeypatch.setattr(model_pages, "_board", lambda: rows)
    monkeypatch.setattr(model_pages, "_of", lambda _: [SimpleNamespace(name=n) for n in names])
    return rows


def row(model: str, rms_deg: float | None, **members: Any) -> Mapping[str, Any]:
    known = {"dataset": "one", "extractor": "e", "availability": 1.0, "rank": 1}
    over = None if rms_deg is None else 10 * rms_deg
    return {**known, "model": model, "own_deg": rms_deg, "over_bound": over, **members}


def test_a_category_of_which_nothing_is_measured_says_so(board: list[Mapping[str, Any]]) -> None:
    board += [row("a", None), row("other", 0.1)]
    assert model_pages.picture("Splines") == "Nothing is published yet."
    assert not any("Splines" in name for name in model_pages.pictures())
    assert model_pages.measure("Splines").count("| – |") >= 3
    (line,) = model_pages.gains("Splines").splitlines()[2:]
    assert line.startswith("| `optical + a` | 0 | – | –")


def test_a_category_shows_the_pipeline_nearest_its_bound(
    board: list[Mapping[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    board += [row("a", 0.2), row("b", 0.1), row("optical + a", 0.05, rank=2, availability=0.5)]
    shown: list[PlottedPipeline] = []

    def rms_deg(pipeline: PlottedPipeline) -> Mapping[str, float]:
        shown.append(pipeline)
        return {"as_is": 0.1, "perfect": 0.03} if len(shown) > 1 else {"as_is": 0.1}

    monkeypatch.setattr(field_plots, "rms_deg", rms_deg)
    alone, both = model_pages.picture("Splines"), model_pages.picture("Splines")
    assert shown == [PlottedPipeline("one", "e", "optical + a")] * 2
    assert alone.endswith("`e + optical + a` on `one`, RMS of unit 0: 0.1 deg as published.")
    assert "0.03 deg with calibration, unit and readings perfect" in both


ARCHITECTURE = {"detector": "CMOS", "mask": "Slit", "dataset": "one"}


@pytest.mark.parametrize(
    ("own_deg", "rows", "used"),
    [
        (None, [], []),
        (0.2, [{"own_deg": 0.2, "studies": []}], []),
        (0.2, [{"own_deg": 0.2, "studies": []}, {"own_deg": 0.3, "studies": ["A2001"]}], [0.3]),
    ],
)
def test_an_architecture_is_drawn_with_what_is_known_of_it(
    own_deg: float | None,
    rows: Sequence[Mapping[str, Any]],
    used: list[float],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Built sensors on either side of the bound, the best, and the best that a study used."""
    measured = {**ARCHITECTURE, "own_deg": own_deg, "bound_deg": own_deg and own_deg / 10}
    built = {("CMOS", "Slit"): [0.5, 0.01], ("CCD", "Slit"): [0.4]}
    monkeypatch.setattr(front, "_architectures", lambda: [measured])
    monkeypatch.setattr(front, "_built", lambda: built)
    monkeypatch.setattr(front, "_boards", lambda: {"one": rows})
    (axes,) = front.figure().axes
    drawn = [line for line in axes.lines if np.size(line.get_xdata())]
    marked: dict[tuple[Any, str], list[float]] = {}
    for line in drawn:
        place = line.get_marker(), str(line.get_fillstyle())
        marked[place] = [*marked.get(place, []), *np.atleast_1d(line.get_xdata()).tolist()]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["CMOS, Slit"]
    assert marked.get(("o", "none"), []) == used
    if own_deg is None:
        assert not drawn
        return
    assert marked["^", "full"] == [0.5]
    assert marked["^", "none"] == [0.01], "below the bound of the simulated sensor"
    assert marked["o", "full"] == [0.2]


def test_built_sensors_stand_with_their_own_detector_and_mask() -> None:
    """Independent of the figure: rows of the hardware table, read as text."""
    with (DATA_DIRECTORY / "hardware.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["accuracy_deg"]]
    seen = [row for row in rows if row["basis"] == "page"]
    found = front._built()
    assert sum(map(len, found.values())) == len(seen)
    for detector, mask in found:
        beside = [row for row in seen if (row["detector"], row["mask"]) == (detector, mask)]
        assert len(found[detector, mask]) == len(beside)
    assert ("CCD", "Single-Ap.") not in found, "TU Delft's and TNO's are CMOS chips"


def test_every_built_sensor_below_its_bound_is_drawn_open() -> None:
    bounds = {(row["detector"], row["mask"]): row["bound_deg"] for row in front._architectures()}
    below = [
        error
        for place, errors in front._built().items()
        for error in errors
        if error < bounds.get(place, 0.0)
    ]
    (axes,) = front.figure().axes
    drawn = [
        float(error)
        for line in axes.lines
        if (line.get_marker(), line.get_fillstyle()) == ("^", "none")
        for error in np.atleast_1d(line.get_xdata())
    ]
    assert sorted(drawn) == sorted(below)
    assert "below the bound" in axes.get_xlabel()


def test_a_pipeline_without_a_pinned_bench_error_has_a_dash(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pins = SimpleNamespace(pins=dict)
    monkeypatch.setattr(limits, "Store", lambda: pins)
    monkeypatch.setattr(limits, "_build", dict)
    rows = [line.split(" | ") for line in limits.best_pipelines().splitlines()[2:]]
    assert rows
    assert {cells[7] for cells in rows} == {"–"}


def test_leaders_that_all_come_near_their_floor_are_said_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    leader: dict[str, Any] = dict.fromkeys(
        ("needed_poses", "needed_low", "needed_high", "error_poses"), 25
    )
    leader |= {"dataset": "one", "extractor": "e", "model": "m", "floor": "none", "poses": 100}
    leader |= {"draws": 8, "reached": 7, "all_deg": [0.1, None]}
    leader |= {"over_bound": None, "answers_poses": None}
    monkeypatch.setattr(curves, "_rows", lambda: [leader])
    (line,) = curves.poses_needed().splitlines()[2:]
    assert [cell.strip() for cell in line.split("|")[2:-1]] == [
        *("e + m", "25", "25 to 25", "25", "more", "100", "none", "–")
    ]
    (line,) = curves.leaders_short_of_poses().splitlines()[2:]
    assert [cell.strip() for cell in line.split("|")[3:-1]] == [
        "1 of 8",
        "100",
        "0.1 and –",
        "none",
    ]
    leader["reached"] = 8
    assert curves.leaders_short_of_poses().startswith("Every leader comes within 10 %")


def test_sweeps_that_are_not_published_are_said_not_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assessment, "_rows", list)
    assert assessment.accuracy() == assessment.faults() == "Nothing is published yet."
    assert assessment.features_without_measure() == "Nothing is left out."


@pytest.mark.parametrize(
    ("answer", "shown"),
    [
        ({"a": {"b": {"c": {"d": "x" * 90}}}}, {"a": {"b": {"c": "…"}}}),
        ({"a": {"b": {"c": {"d": "x"}}}}, {"a": {"b": {"c": {"d": "x"}}}}),
        ("x" * 161, "x" * 160 + "…"),
        (
            list("abcdefghij"),
            [*"abcdefghij"[: examples.LONGEST_LIST], f"… {10 - examples.LONGEST_LIST} more"],
        ),
        ({"latency_us": 3.0, "time_ratio": None}, {"latency_us": "…", "time_ratio": None}),
    ],
)
def test_examples_of_answers_are_cut_where_they_are_long_or_deep(answer: Any, shown: Any) -> None:
    assert examples._shorten(answer) == shown


@pytest.mark.parametrize(
    ("kind", "text", "shown"),
    [
        ("image/png", "PNG", "200, `image/png`."),
        ("text/csv", "a,b\n1,2\n", "200, `text/csv`:\n\n```json\na,b\n1,2\n```"),
        ("application/json", '{"a": 1}', '200, `application/json`:\n\n```json\n{"a": 1}\n```'),
    ],
)
def test_only_answers_that_are_text_are_shown(kind: str, text: str, shown: str) -> None:
    said = examples._exchange("GET /x", None, (200, kind, text))
    assert said == f"```http\nGET /x\n```\n\n{shown}"


def test_a_body_that_is_sent_stands_below_its_request() -> None:
    said = examples._exchange("POST /x", {"é": 1}, (200, "text/csv", "a"))
    assert said.startswith('```http\nPOST /x\n\n{"é": 1}\n```\n\n200, ')


def test_of_many_words_of_a_parameter_one_is_shown() -> None:
    letters = [f"w{number}" for number in range(30)]
    assert examples._takes({"type": "string", "enum": letters[:2]}) == "`w0`, `w1`"
    several = {"type": "array", "items": {"type": "string", "enum": letters}}
    assert examples._takes(several) == "one of 30 values, such as `w0`; repeatable"


def test_an_example_of_an_export_that_fails_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export, "EXPORTS", ("dataset export no-such-set --out made",))
    with pytest.raises(
        RuntimeError, match=r"^sunatlas dataset export no-such-set.* failed: .*no-s"
    ):
        export.export_example()
    monkeypatch.setattr(export, "EXPORTS", ())
    monkeypatch.setattr(export, "READING", "print(open('made/none').read())\n")
    with pytest.raises(RuntimeError, match=r"(?s)^the example of the docs fails: .*made/none"):
        export.export_example()
