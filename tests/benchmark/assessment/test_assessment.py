"""The assessment: definitions, quantities from stored rows, and verdicts beside the survey's."""

from __future__ import annotations

import math

import pytest

from algorithms.discovery import discover_extractors
from benchmark.assessment import assess as assessment
from benchmark.assessment.assess import assess
from benchmark.assessment.definitions import DEFINITIONS
from benchmark.assessment.measures import SCORED, SWEPT, Unmeasured
from benchmark.results.store import Store
from benchmark.running.times import Time
from benchmark.sweeps.run import components_of
from survey_data.tables import load


def row(sweep, point, value=None, **numbers):
    return {
        "series": "disc", "sweep": sweep, "point": point, "value": value, "n": 300,
        "extractor": "bctm", "status": "ok", "reason": "",
        "found_fraction": 1.0, "kept_fraction": 1.0, "rms": 0.01, "bias": 0.0,
           "bound": 0.005, "over_bound": 2.0, **numbers,
    }  # fmt: skip


def score(**fields):
    return {
        "dataset": "d", "condition": "nominal", "mask": "Single-Ap.", "detector": "CMOS",
        "model": "m", "status": "ok", "rms_deg": 0.1, "availability": 1.0, **fields,
    }  # fmt: skip


def test_definitions_are_of_the_survey_s_properties_in_its_order():
    table = load().feature_assessment
    assert list(DEFINITIONS) == list(dict.fromkeys(table["property"]))
    measured = {name for name, d in DEFINITIONS.items() if d.measured}
    assert measured == {*SWEPT, *SCORED, "Computationally light"}
    assert set(DEFINITIONS) - measured == {"Algorithmically simple", "Feature pattern agnostic"}
    for definition in DEFINITIONS.values():
        assert definition.measure
        assert bool(definition.limits()) == definition.measured


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("High precision", 1.5, 2),
        ("High precision", 1.51, 1),
        ("High precision", 3.01, 0),
        ("High precision", math.nan, 0),
        ("Feature tracking", 0.95, 2),
        ("Feature tracking", 0.5, 1),
        ("Feature tracking", 0.49, 0),
        ("Feature tracking", math.nan, 0),
        ("Robust to noise", 5.0, 2),
        ("Robust to noise", 10.0, 1),
        ("Resolution scaling", -1.2, 2),
        ("Resolution scaling", -0.2, 0),
    ],
)
def test_limits_hold_where_they_are(name, value, expected):
    assert DEFINITIONS[name].score(value) == expected


def test_ratios_are_of_the_named_points_and_nan_where_too_little_is_found():
    rows = [row("pedestal", "0", rms=0.01), row("pedestal", "0.5", rms=0.04)]
    assert SWEPT["No pre-processing"](rows) == [(4.0, "disc")]
    rows[1]["found_fraction"] = 0.5
    ((value, _),) = SWEPT["No pre-processing"](rows)
    assert math.isnan(value)
    rows = [row("location", "middle", rms=0.01), row("location", "anywhere", rms=0.02)]
    assert SWEPT["Feature location agnostic"](rows) == [(2.0, "disc")]
    rows = [row("profile", "flat", over_bound=2.0), row("profile", "gaussian", over_bound=5.0)]
    assert SWEPT["Feature profile agnostic"](rows) == [(2.5, "disc")]


def test_precision_scaling_and_phase_follow_their_formulas():
    # an error that is a fixed share of a pixel: relative to the feature it falls as 1 / size
    rows = [row("size", str(r), float(r), rms=0.05) for r in (2, 4, 8)]
    ((slope, _),) = SWEPT["Resolution scaling"](rows)
    assert slope == pytest.approx(-1.0)
    rows = [row("phase", "0", 0.0, rms=0.3), row("phase", "0.5", 0.5, rms=0.4)]
    ((rms, _),) = SWEPT["Sub-pixel resolution"](rows)
    assert rms == pytest.approx(math.sqrt((0.09 + 0.16) / 2))
    assert SWEPT["High precision"]([row("reference", "disc", over_bound=1.7)]) == [(1.7, "disc")]
    rows = [row("tracking", "glint", kept_fraction=0.6)]
    assert SWEPT["Feature tracking"](rows) == [(0.6, "disc")]


def test_gain_is_told_over_that_of_independent_features():
    rows = [row("features", "1", 1.0, rms=0.1), row("features", "25", 25.0, rms=0.025)]
    ((gain, _),) = SWEPT["Multi-feature"](rows)
    assert gain == pytest.approx(4.0 / 5.0)
    refused = {**row("", ""), "series": "grid", "status": "refused", "n": 0, "rms": None}
    assert SWEPT["Multi-feature"]([row("noise", "5", 5.0), refused])[0][0] == 0.0
    with pytest.raises(Unmeasured, match="does not read a single feature"):
        SWEPT["Multi-feature"]([row("features", "25", 25.0)])


def test_robust_to_noise_ends_at_the_first_level_that_fails():
    levels = {5.0: 2.0, 10.0: 3.5, 20.0: 2.9, 50.0: 2.0, 200.0: 99.0}
    rows = [row("noise", f"{s:g}", s, over_bound=ratio) for s, ratio in levels.items()]
    assert SWEPT["Robust to noise"](rows) == [(20.0, "disc")]
    ((ratio, _),) = SWEPT["Noise level agnostic"](rows)
    assert ratio == pytest.approx(99.0 / 2.0)
    ((none, _),) = SWEPT["Robust to noise"]([row("noise", "50", 50.0, over_bound=9.0)])
    assert math.isnan(none)


def test_a_design_that_was_refused_is_no_outcome():
    refused = {**row("size", "2"), "n": 0, "rms": None, "status": "refused", "reason": "too small"}
    rows = [refused, *(row("size", str(r), float(r)) for r in (4, 8))]
    assert not math.isnan(SWEPT["Resolution scaling"](rows)[0][0])
    with pytest.raises(Unmeasured, match=r"no reference feature .* `tracking`"):
        SWEPT["Feature tracking"](rows)
    with pytest.raises(Unmeasured, match="nothing is stored of the sweep `noise`"):
        SWEPT["Robust to noise"]([])


def test_applicability_takes_the_best_of_its_group_in_the_nominal_condition():
    rows = [
        score(rms_deg=0.4),
        score(rms_deg=0.2, dataset="e", mask="Multi-Ap."),
        score(rms_deg=0.01, condition="low-noise"),
        score(rms_deg=0.01, availability=0.5),
        score(rms_deg=3.0, mask="L-Slit", detector="Event"),
        score(rms_deg=0.1, mask="Lens", detector="CCD", dataset="ccd-lens"),
    ]
    best = {name: measure(rows)[0] for name, measure in SCORED.items()}
    assert best["Pinhole Mask"] == (0.2, "e with m")
    assert best["Slit Mask"][0] == 3.0 == best["Other Detector"][0]
    assert best["Other Mask"][0] == 0.1 == best["CCD Detector"][0] == best["Blooming features"][0]
    assert math.isnan(SCORED["CCD Detector"](rows[:2])[0][0])
    with pytest.raises(Unmeasured, match="no published score"):
        SCORED["CCD Detector"]([])


def test_without_results_nothing_is_measured_and_every_reason_is_given(tmp_path):
    assessed = assess(tmp_path)
    assert len(assessed) == 19
    verdicts = [verdict for one in assessed for verdict in one.verdicts]
    assert len(verdicts) == 19 * 21
    assert {v.agreement for v in verdicts} == {"not measured"}
    assert all(v.reason and v.measured is None and v.value is None for v in verdicts)
    survey = load().feature_assessment["score"].tolist()
    assert [v.survey for v in verdicts] == survey
    assert assessment.totals_of(assessed)["not measured"] == 399


def test_hough_transforms_are_told_apart_by_their_study(tmp_path):
    known = discover_extractors()
    found = {one.method: set(one.extractors) for one in assess(tmp_path)}
    hough = {n for n, e in known.items() if e.about.taxonomy == "HT" and e.about.origin == "survey"}
    assert found["BHT"] | found["CHT"] <= hough
    assert all("Liu2016" in known[name].about.studies for name in found["BHT"])
    assert all("Adatrao2016" in known[name].about.studies for name in found["CHT"])
    for one in assess(tmp_path):
        assert all(known[n].about.origin == "survey" for n in one.extractors)


def test_verdicts_compare_with_the_survey_and_costs_are_medians(tmp_path):
    known = {"bctm": discover_extractors()["bctm"]}
    swept = [row("reference", "disc", over_bound=1.2)]
    Store(tmp_path).write({}, [], [{**one, "unit": "px"} for one in swept], components_of(known))
    times = {
        (name, "bctm", model): Time(name, "bctm", model, 1.0, ratio, ratio, "")
        for name, ratio in (("d0", 0.1), ("d1", 40.0), ("d2", 20.0), ("d3", None))
        for model in ("lut", "linear")
    }
    bctm = next(one for one in assess(tmp_path, known, times) if one.method == "BCTM")
    found = {verdict.name: verdict for verdict in bctm.verdicts}
    precise = found["High precision"]  # the survey says 0
    assert (precise.measured, precise.value, precise.agreement) == (2, 1.2, "opposed")
    light = found["Computationally light"]  # the survey says 1
    assert (light.measured, light.value, light.series, light.agreement) == (
        1, 20.0, "3 data sets", "agrees",
    )  # fmt: skip
    assert sum(bctm.counts.values()) == 21
    untimed = next(one for one in assess(tmp_path, known) if one.method == "BCTM")
    (light,) = (v for v in untimed.verdicts if v.name == "Computationally light")
    assert light.measured is None
    assert "sunatlas leaderboard times" in light.reason
