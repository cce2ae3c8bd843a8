"""What figures show, recounted from the survey's CSV files without the project's code."""

from __future__ import annotations

import csv
import itertools
import math
import shlex
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

import survey_data
from api.figures.catalogue import LEVELS, TITLES, evidence_map, figure
from api.figures.statements import number_of_studies, statements
from api.http.measurements import Measurements
from benchmark.plan.combinations import cells, scorable
from benchmark.results.store import PUBLISHED, Store
from registry.catalogue import catalogue
from registry.evidence import Evidence
from registry.fitting import stages
from registry.possibility import GIVES, TELLS
from registry.studies import facts
from registry.taxonomy import InvalidValueError

TABLES = Path(survey_data.__file__).parent
FLOWS = ("error", "performance", "cross-analysis", "task", "aggregate")
Values = dict[str, dict[str, set[str]]]


def read(name: str) -> list[dict[str, str]]:
    with (TABLES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def values() -> Values:
    """Study -> level -> values."""
    found: Values = {row["key"]: defaultdict(set) for row in read("studies")}
    category = {(r["attribute"], r["value"]): r["category"] for r in read("taxonomy")}
    ring = {row["model"]: row["calibration"] for row in read("model_families")}
    for row in read("attributes"):
        attribute, value = row["attribute"], row["value"]
        if not value:
            continue
        of = found[row["study"]]
        of[attribute].add(value)
        if attribute == "model":
            of["model_category"].add(category["model", value])
            of["calibration"].add("None" if value == "None" else ring.get(value, "offline"))
        if attribute == "extractor":
            of["extractor_family"].add(category["extractor", value])
    return found


@pytest.fixture(scope="module")
def sensors() -> dict[str, set[tuple[str, str]]]:
    """Study with several sensors -> detector and mask of each."""
    found: dict[str, set[tuple[str, str]]] = defaultdict(set)
    for row in read("architectures"):
        found[row["study"]].add((row["detector"], row["mask"]))
    return found


def having(
    values: Values,
    sensors: dict[str, set[tuple[str, str]]],
    one: tuple[str, str],
    other: tuple[str, str],
) -> set[str]:
    """Studies with both values, on one sensor where detector and mask are meant."""
    keys = {k for k, of in values.items() if one[1] in of[one[0]] and other[1] in of[other[0]]}
    if {one[0], other[0]} != {"detector", "mask"}:
        return keys
    named = dict([one, other])
    pair = (named["detector"], named["mask"])
    return {key for key in keys if key not in sensors or pair in sensors[key]}


@pytest.mark.parametrize("name", FLOWS)
def test_every_flow_has_the_studies_with_both_values(
    name: str, values: Values, sensors: dict[str, set[tuple[str, str]]]
) -> None:
    rows = figure(name, facts()).rows
    links = {
        ((row["level"], row["value"]), (row["next_level"], row["next_value"])): set(row["studies"])
        for row in rows
        if row["next_level"]
    }
    expected = {}
    for one, other in itertools.pairwise(LEVELS[name]):
        pairs = {
            ((one, a), (other, b)) for of in values.values() for a in of[one] for b in of[other]
        }
        expected |= {pair: having(values, sensors, *pair) for pair in pairs}
    assert links == {pair: keys for pair, keys in expected.items() if keys}


@pytest.mark.parametrize("name", FLOWS)
def test_every_node_has_the_studies_with_its_value(name: str, values: Values) -> None:
    rows = [row for row in figure(name, facts()).rows if not row["next_level"]]
    found = {(row["level"], row["value"]): set(row["studies"]) for row in rows}
    expected: dict[tuple[str, str], set[str]] = defaultdict(set)
    for key, of in values.items():
        for level in LEVELS[name]:
            for value in of[level]:
                expected[level, value].add(key)
    assert found == expected
    assert all(row["count"] == len(row["studies"]) for row in rows)


def test_arcs_of_the_sunburst_hold_the_studies_of_their_models(values: Values) -> None:
    rows = figure("models", facts()).rows
    models = {row["model"]: set(row["studies"]) for row in rows if row["level"] == "model"}
    expected: dict[str, set[str]] = defaultdict(set)
    for key, of in values.items():
        for model in of["model"]:
            expected[model].add(key)
    assert models == expected
    for row in rows:
        inside = [
            r
            for r in rows
            if r["level"] == "model"
            and r["model_category"] == row["model_category"]
            and (row["level"] == "model_category" or r["calibration"] == row["calibration"])
            and row["model"] in ("", r["model"])
        ]
        assert row["memberships"] == sum(len(models[r["model"]]) for r in inside)
        assert set(row["studies"]) == set().union(*(models[r["model"]] for r in inside))
    categories = [row for row in rows if row["level"] == "model_category"]
    assert sum(row["memberships"] for row in categories) == sum(map(len, expected.values())) == 178


def test_the_middle_ring_says_which_models_are_calibrated_in_operation() -> None:
    rings = {row["model"]: row["calibration"] for row in read("model_families")}
    online = {model for model, ring in rings.items() if ring == "online"}
    rows = figure("models", facts()).rows
    assert {r["model"] for r in rows if r["level"] == "model" and r["calibration"] == "online"} == (
        online & {r["model"] for r in rows}
    )
    assert online


def test_publications_are_those_of_the_table_of_studies() -> None:
    rows = figure("publications", facts()).rows
    per_year = Counter(row["year"] for row in read("studies"))
    found: Counter[str] = Counter()
    for row in rows:
        assert row["count"] == len(row["studies"])
        if row["part"] == "year":
            found[row["value"]] += row["count"]
    assert found == per_year
    kinds = {(row["year"], row["type"]): 0 for row in read("studies")}
    for row in read("studies"):
        kinds[row["year"], row["type"]] += 1
    assert {(r["value"], r["stack"]): r["count"] for r in rows if r["part"] == "year"} == kinds
    venues: dict[str, set[str]] = defaultdict(set)
    for row in rows:
        if row["part"] == "venue":
            venues[row["value"]].update(row["studies"])
    expected: dict[str, set[str]] = defaultdict(set)
    known = {row["study"]: row["venue"] for row in read("venues")}
    for row in read("studies"):
        expected[known.get(row["key"], "")].add(row["key"])
    assert venues == expected


def test_the_years_that_the_survey_names_are_those_drawn() -> None:
    # "steady growth since 2001", "peaked in 2017 and again in 2022, with a slight decline in 2023"
    count: Counter[int] = Counter()
    for row in figure("publications", facts()).rows:
        if row["part"] == "year":
            count[int(row["value"])] += row["count"]
    assert min(count) == 2001
    assert [year for year, _ in count.most_common(2)] == [2017, 2022]
    assert count[2023] < count[2022]
    assert count[2001] == 4, "the criterion of inclusion begins with 2002; four keys are of 2001"


def test_every_sensor_is_a_line_with_the_numbers_that_its_study_states(
    sensors: dict[str, set[tuple[str, str]]], values: Values
) -> None:
    rows = figure("coordinates", facts()).rows
    assert {row["study"] for row in rows} == set(values)
    for key, of in values.items():
        found = {(row["detector"], row["mask"]) for row in rows if row["study"] == key}
        every = itertools.product(of["detector"] or {None}, of["mask"] or {None})
        assert found == (sensors.get(key) or set(every))
    for row in rows:
        of = values[row["study"]]
        accuracies = [float(value) for value in of["accuracy_deg"]]
        assert row["accuracy_deg"] == (min(accuracies) if accuracies else None)
        kind = next(iter(of["accuracy_kind"]), None)
        divisor = {"3sigma": 3.0, "max": 3.0, "p95": 1.96, "mean": 0.7979}.get(kind or "", 1.0)
        rms = None if not accuracies else min(accuracies) / divisor
        assert (row["accuracy_rms_deg"], row["accuracy_kind"]) == (rms, kind)
        fields = [float(value) for value in of["fov_deg"]]
        assert row["fov_deg"] == (max(fields) if fields else None)


@pytest.mark.parametrize(
    ("rows", "columns"),
    [("detector", "mask"), ("task", "error"), ("accuracy", "model_category"), ("model", "model")],
)
def test_a_matrix_counts_the_studies_with_both_and_shows_every_gap(
    rows: str, columns: str, values: Values, sensors: dict[str, set[tuple[str, str]]]
) -> None:
    table = evidence_map(facts(), {}, rows, columns).rows
    taxonomy = facts().taxonomy
    assert len(table) == len(taxonomy.values(rows)) * len(taxonomy.values(columns))
    for row in table:
        keys = having(values, sensors, (rows, row["row"]), (columns, row["column"]))
        if rows == columns:
            pair = {row["row"], row["column"]}
            keys = {key for key, of in values.items() if pair <= of[rows]}
        assert set(row["studies"]) == keys
        assert row["count"] == len(keys)


def test_a_model_is_impossible_with_another_category_than_its_own() -> None:
    table = evidence_map(facts(), {}, "model", "model_category").rows
    possible = {(row["row"], row["column"]) for row in table if row["state"] != "impossible"}
    assert ("SPM", "Geometric") in possible
    assert ("SPM", "LUT") not in possible
    assert len(possible) == len(facts().taxonomy.values("model"))


def test_states_are_drawn_as_cells_of_their_own(evidence: Evidence) -> None:
    found = evidence_map(facts(), evidence=evidence)
    assert sum(found.counts.values()) == len(found.rows) == 100
    for drawing in found.drawings.values():
        root = ET.fromstring(drawing.document("t", "d", ""))
        marks = [set(e.get("class", "").split()) for e in root.iter()]
        cells = [classes for classes in marks if "cell" in classes]
        assert len(cells) == len(found.rows)
        for state in ("impossible", "unknown", "unstudied"):
            assert sum(state in classes for classes in cells) == found.counts[state] > 0
        assert sum("dot" in classes for classes in marks) == found.counts["measured"]


@pytest.fixture(scope="module")
def measurements() -> Measurements:
    return Measurements()


@pytest.fixture(scope="module")
def evidence(measurements: Measurements) -> Evidence:
    return Evidence(catalogue(), measurements.pipelines, scorable())


def place(row: Any) -> tuple[str, str, str]:
    return row["dataset"], row["extractor"], row["model"]


@pytest.fixture(scope="module")
def own_errors(measurements: Measurements) -> dict[tuple[str, str, str], float]:
    """Geometric mean over units of the error under the first condition, by pipeline."""
    units: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    for row in Store(PUBLISHED).rows(unit=None):
        first = measurements.presets[row["dataset"]].conditions[0]
        if row["condition"] == first and row["charged_deg"]:
            units[place(row)].append(row["charged_deg"])
    return {key: math.exp(sum(map(math.log, of)) / len(of)) for key, of in units.items()}


@pytest.mark.parametrize(
    ("rows", "columns"), [("detector", "mask"), ("detector", "extractor"), ("mask", "model")]
)
def test_each_pair_is_in_the_state_that_sets_of_studies_and_scores_say(
    rows: str,
    columns: str,
    *,
    values: Values,
    sensors: dict[str, set[tuple[str, str]]],
    evidence: Evidence,
    measurements: Measurements,
    own_errors: dict[tuple[str, str, str], float],
) -> None:
    """Independent: studies from the files, scores from the rows of the record."""
    presets = measurements.presets
    own = catalogue()

    def has(row: Any, level: str, value: str) -> bool:
        if level in ("detector", "mask"):
            return bool(getattr(presets[row["dataset"]], level) == value)
        if level == "extractor":
            return own.extractor(row["extractor"]).about.taxonomy == value
        meant = facts().taxonomy.kinds("model", value)
        return not set(meant).isdisjoint(stages(own.model(row["model"])))

    scores = [score for score in measurements.nominal.values() if score["rms_deg"] is not None]
    for row in evidence_map(facts(), {}, rows, columns, evidence=evidence).rows:
        pair = (rows, row["row"]), (columns, row["column"])
        scored = [score for score in scores if all(has(score, *value) for value in pair)]
        assert row["pipelines"] == len(scored)
        unknown = {
            key
            for key, of in values.items()
            for (level, value), other in (pair, pair[::-1])
            if value in of[level] and not of[other[0]]
        }
        assert set(row["unknown"]) == unknown
        assert row["count"] == len(having(values, sensors, *pair))
        assert (row["state"] == "measured") == bool(scored)
        if row["state"] == "studied":
            assert row["count"]
        if row["state"] in ("impossible", "unknown", "unstudied"):
            assert not row["count"]
            assert (row["state"] == "impossible") == bool(row["reason"])
        if row["state"] == "unknown":
            assert unknown
        if row["state"] == "unstudied":
            assert not unknown
        if scored and row["best_own_deg"] is not None:
            assert row["best_own_deg"] == pytest.approx(
                min(own_errors[place(score)] for score in scored if score["availability"] >= 0.95)
            )


def test_every_data_set_gives_readings_that_its_detector_gives_and_its_mask_lets_tell(
    measurements: Measurements,
) -> None:
    for preset in measurements.presets.values():
        assert str(preset.observation) in GIVES[preset.detector]
        assert str(preset.observation) in TELLS.get(preset.mask, {str(preset.observation)})
    assert set(GIVES) == set(facts().taxonomy.values("detector"))


def test_pairs_that_no_extractor_can_read_are_impossible_where_no_study_has_them(
    evidence: Evidence,
) -> None:
    found = {
        (row["row"], row["column"]): row
        for row in evidence_map(facts(), {}, "detector", "extractor", evidence=evidence).rows
    }
    assert found["CMOS", "Voltage balance"]["state"] == "impossible"
    assert found["QPD", "BCTM"]["state"] == "impossible"
    assert "QPD gives currents" in found["QPD", "BCTM"]["reason"]
    assert found["Event", "ESCM"]["state"] == "measured"
    against = {
        pair: row["studies"] for pair, row in found.items() if row["reason"] and row["count"]
    }
    # Merchan2023 has both an event sensor's method and CMOS; Post2013 two sensors.
    assert against == {("CMOS", "ESCM"): ["Merchan2023"], ("PVA", "BCTM"): ["Post2013"]}


def test_a_gap_leads_to_what_could_be_measured(evidence: Evidence) -> None:
    for rows, columns in (("detector", "mask"), ("extractor", "model"), ("detector", "model")):
        for row in evidence_map(facts(), {}, rows, columns, evidence=evidence).rows:
            if row["state"] == "impossible":
                assert row["command"] == row["leads_to"] == ""
            if "--extractor" in row["command"]:
                words = shlex.split(row["command"])
                named = dict(zip(words[2::2], words[3::2], strict=True))
                of = {"extractor": named["--extractor"], "model": named["--model"]}
                found = cells(named["--dataset"], None, of["extractor"], of["model"])
                assert found, row["command"]
    sensor = next(
        row
        for row in evidence_map(facts(), evidence=evidence).rows
        if (row["row"], row["column"]) == ("CCD", "Single-Ap.")
    )
    assert sensor["state"] == "measured"
    assert sensor["leads_to"] == "/architectures/CCD/Single-Ap."


@pytest.mark.parametrize(("rows", "columns"), [("colour", "mask"), ("detector", "masks")])
def test_an_unknown_attribute_is_refused_by_naming_those_there_are(rows: str, columns: str) -> None:
    with pytest.raises(InvalidValueError) as caught:
        evidence_map(facts(), {}, rows, columns)
    assert all(level in str(caught.value) for level in facts().taxonomy.levels)


def test_an_unknown_figure_is_refused_by_naming_those_there_are() -> None:
    with pytest.raises(InvalidValueError) as caught:
        figure("errors", facts())
    assert caught.value.nearest == "error"
    assert all(name in str(caught.value) for name in TITLES)


@pytest.mark.parametrize("name", TITLES)
def test_a_filter_keeps_the_studies_that_have_the_value(name: str, values: Values) -> None:
    found = figure(name, facts(), {"detector": "Event"})
    expected = {key for key, of in values.items() if "Event" in of["detector"]}
    assert found.studies == len(expected) == 6
    assert set().union(*(row["studies"] for row in found.rows)) == expected


@pytest.mark.parametrize("name", TITLES)
def test_a_figure_has_sentences_and_columns_that_every_row_keeps(name: str) -> None:
    found = figure(name, facts())
    assert all(tuple(row) == found.columns for row in found.rows)
    assert all(text.endswith(".") and "None" not in text for text in found.text)
    for drawing in found.drawings.values():
        assert ">None" not in drawing.body


def test_statements_of_the_survey_stand_at_the_figure_of_their_attributes() -> None:
    given: dict[str, Any] = {name: {s.id for s in statements(name)} for name in TITLES}
    assert {f"F{n:02}" for n in range(1, 10)} == given["error"]
    assert {"F21", "F23"} <= given["task"]
    assert {"F46", "F47"} == given["models"]
    assert given["publications"] == {"F51"}
    verdicts = {s.id: s.verdict for name in TITLES for s in statements(name)}
    assert verdicts["F51"] == "reproduced"
    assert "128" in number_of_studies()
    assert "129" in number_of_studies()
