"""The assessment: definitions, quantities from stored rows, and verdicts beside the survey's."""

from __future__ import annotations

import math
import re

import pytest

from algorithms.discovery import discover_extractors
from benchmark.assessment import assess as assessment
from benchmark.assessment.assess import assess
from benchmark.assessment.definitions import DEFINITIONS
from benchmark.assessment.measures import SCORED, SWEPT, NotMeasuredError
from benchmark.results.times import Time
from benchmark.sweeps.record import RECORD, point_of
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
    measured = {name for name, d in DEFINITIONS.items() if d.has_experiment}
    assert measured == {*SWEPT, *SCORED, "Computationally light"}
    assert set(DEFINITIONS) - measured == {
        "No pre-processing", "Algorithmically simple", "Feature pattern agnostic",
    }  # fmt: skip
    for definition in DEFINITIONS.values():
        assert definition.measure
        assert (
            bool(definition.limits()) == definition.has_experiment == (definition.judged != "never")
        )
        assert bool(definition.why) == (definition.judged in ("claimed", "failed"))


def test_what_a_table_does_not_claim_no_outcome_opposes():
    def judged(name):
        """(survey, measured) that the definition lets be compared."""
        pairs = [(survey, measured) for survey in (0, 1, 2) for measured in (0, 1, 2)]
        return {pair for pair in pairs if not DEFINITIONS[name].why_undecided(*pair)}

    everything = {(survey, measured) for survey in (0, 1, 2) for measured in (0, 1, 2)}
    assert judged("High precision") == judged("Noise level agnostic") == everything
    # the case study used another mask: not that the method cannot
    claims = {pair for pair in everything if pair[0] > 0}
    assert judged("Slit Mask") == judged("Other Detector") == judged("Blooming features") == claims
    # a scene that looks alike everywhere is passed by whoever depends on the place, too
    failures = {pair for pair in everything if pair[1] < 2}
    assert judged("Feature location agnostic") == failures
    assert judged("No pre-processing") == judged("Algorithmically simple") == set()


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


def only(values):
    """(value, why) of the one series there is."""
    ((value, _, why),) = values
    return value, why


def test_ratios_are_of_the_named_points_and_nan_says_why():
    missing = SWEPT["Robust to missing features"]
    rows = [row("missing", "0", rms=0.01), row("missing", "0.2", rms=0.04)]
    assert missing(rows) == [(4.0, "disc", "")]
    rows[1]["found_fraction"] = 0.5
    value, why = only(missing(rows))
    assert math.isnan(value)
    assert why == "50% found at missing `0.2`"
    rows[1] |= {"status": "refused", "reason": "nothing there", "rms": None}
    assert only(missing(rows))[1] == "refused at missing `0.2`: nothing there"
    # the place is held against the bound there: a sensor's own loss is not the method's
    rows = [row("location", "middle", over_bound=1.0), row("location", "anywhere", over_bound=2.0)]
    assert SWEPT["Feature location agnostic"](rows) == [(2.0, "disc", "")]
    rows = [row("profile", "flat", over_bound=2.0), row("profile", "gaussian", over_bound=5.0)]
    assert SWEPT["Feature profile agnostic"](rows) == [(2.5, "disc", "")]


def test_a_series_without_a_bound_is_no_outcome():
    rows = [row("location", "middle", over_bound=None), row("location", "anywhere")]
    with pytest.raises(NotMeasuredError, match="disc: no bound at location `middle`"):
        SWEPT["Feature location agnostic"](rows)


def test_precision_scaling_and_phase_follow_their_formulas():
    # an error that is a fixed share of a pixel: relative to the feature it falls as 1 / size
    rows = [row("size", str(r), float(r), rms=0.05) for r in (2, 4, 8)]
    slope, _ = only(SWEPT["Resolution scaling"](rows))
    assert slope == pytest.approx(-1.0)
    rows = [row("phase", "0", 0.0, rms=0.3), row("phase", "0.5", 0.5, rms=0.4)]
    rms, _ = only(SWEPT["Sub-pixel resolution"](rows))
    assert rms == pytest.approx(math.sqrt((0.09 + 0.16) / 2))
    rows = [row("reference", "disc", over_bound=1.7), row("reference", "gaussian", over_bound=9.0)]
    assert SWEPT["High precision"](rows) == [(1.7, "disc", "")]
    rows = [row("tracking", "glint", kept_fraction=0.6)]
    assert SWEPT["Feature tracking"](rows) == [(0.6, "disc", "")]
    for found, said in ((1.0, "no position to compare"), (0.1, "10% found at tracking `glint`")):
        rows = [row("tracking", "glint", kept_fraction=None, found_fraction=found)]
        value, why = only(SWEPT["Feature tracking"](rows))
        assert math.isnan(value)
        assert why == said


def test_gain_is_told_over_that_of_independent_features():
    rows = [row("features", "1", 1.0, rms=0.1), row("features", "25", 25.0, rms=0.025)]
    gain, _ = only(SWEPT["Multi-feature"](rows))
    assert gain == pytest.approx(4.0 / 5.0)
    refused = {**row("", ""), "series": "grid", "status": "refused", "n": 0, "rms": None}
    assert SWEPT["Multi-feature"]([row("noise", "5", 5.0), refused])[0][0] == 0.0
    with pytest.raises(NotMeasuredError, match="does not read a single feature"):
        SWEPT["Multi-feature"]([row("features", "25", 25.0)])


def test_robust_to_noise_ends_at_the_first_level_that_fails():
    levels = {5.0: 2.0, 10.0: 3.5, 20.0: 2.9, 50.0: 2.0, 200.0: 99.0}
    rows = [row("noise", f"{s:g}", s, over_bound=ratio) for s, ratio in levels.items()]
    assert SWEPT["Robust to noise"](rows) == [(20.0, "disc", "")]
    none, why = only(SWEPT["Robust to noise"]([row("noise", "50", 50.0, over_bound=9.0)]))
    assert math.isnan(none)
    # everything is found: what fails is the size of the error, and that is what is said
    assert re.findall(r"[\d.]+", why) == ["9", "50"]
    assert "bound" in why


def test_a_level_error_is_agnostic_of_the_noise_and_one_at_the_bound_is_not():
    snrs = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)
    level = DEFINITIONS["Noise level agnostic"]
    at_bound = [row("noise", f"{s:g}", s, rms=1.0 / s, over_bound=1.0) for s in snrs]
    ratio, _ = only(SWEPT[level.name](at_bound))
    assert ratio == pytest.approx(20.0)
    assert level.score(ratio) == 0
    floor = [row("noise", f"{s:g}", s, rms=0.29, over_bound=s) for s in snrs]
    ratio, _ = only(SWEPT[level.name](floor))
    assert ratio == 1.0
    assert level.score(ratio) == 2
    floor[1]["found_fraction"] = 0.5
    assert only(SWEPT[level.name](floor))[1] == "50% found at noise `10`"


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
    assert best["Pinhole Mask"] == (0.2, "e with m", "")
    assert best["Slit Mask"].value == 3.0 == best["Other Detector"].value
    assert best["Other Mask"].value == 0.1 == best["CCD Detector"].value
    assert best["Blooming features"].value == 0.1
    with pytest.raises(NotMeasuredError, match="no published score"):
        SCORED["CCD Detector"]([])


def test_without_results_nothing_is_measured_and_every_reason_is_given(tmp_path):
    assessed = assess(tmp_path)
    assert len(assessed) == 19
    verdicts = [verdict for one in assessed for verdict in one.verdicts]
    assert len(verdicts) == 19 * 21
    assert {v.agreement for v in verdicts} == {"not judged", "not measured"}
    for v in verdicts:
        never = not DEFINITIONS[v.name].has_experiment
        unclaimed = DEFINITIONS[v.name].judged == "claimed" and v.survey == 0
        assert (v.agreement == "not judged") == (never or unclaimed)
    assert all(v.reason and v.measured is None and v.value is None for v in verdicts)
    survey = load().feature_assessment["score"].tolist()
    assert [v.survey for v in verdicts] == survey
    totals = assessment.totals_of(assessed)
    assert totals["not judged"] + totals["not measured"] == 399 == sum(totals.values())


def test_hough_transforms_are_told_apart_by_their_study(tmp_path):
    known = discover_extractors()
    found = {one.method: set(one.extractors) for one in assess(tmp_path)}
    hough = {n for n, e in known.items() if e.about.taxonomy == "HT" and e.about.origin == "survey"}
    assert found["BHT"] | found["CHT"] <= hough
    assert all("Liu2016" in known[name].about.studies for name in found["BHT"])
    assert all("Adatrao2016" in known[name].about.studies for name in found["CHT"])
    for one in assess(tmp_path):
        assert all(known[n].about.origin == "survey" for n in one.extractors)


def keep(directory, swept):
    """Write rows of sweeps to a record."""
    facts = {"unit": "px", "extractor_taxonomy": "BCTM", "extractor_version": 1, "key": ""}
    RECORD.write({point_of(one): {**one, **facts} for one in swept}, directory)


def test_verdicts_compare_with_the_survey_and_costs_are_medians(tmp_path):
    known = {"bctm": discover_extractors()["bctm"]}
    swept = [row("reference", "disc", over_bound=1.2)]
    keep(tmp_path, swept)
    times = {
        (name, "bctm", model): Time(name, "bctm", model, ratio, ratio)
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
    assert tuple(bctm.counts) == assessment.VERDICTS
    untimed = next(one for one in assess(tmp_path, known) if one.method == "BCTM")
    (light,) = (v for v in untimed.verdicts if v.name == "Computationally light")
    assert light.measured is None
    assert "sunatlas leaderboard times" in light.reason


def test_what_is_not_judged_keeps_its_number_and_says_why(tmp_path):
    known = {"bctm": discover_extractors()["bctm"]}
    swept = [row("location", "middle"), row("location", "anywhere", over_bound=2.2)]
    swept += [row("noise", "50", 50.0, over_bound=9.0)]
    keep(tmp_path, swept)
    bctm = next(one for one in assess(tmp_path, known) if one.method == "BCTM")
    found = {verdict.name: verdict for verdict in bctm.verdicts}
    anywhere = found["Feature location agnostic"]
    assert (anywhere.measured, anywhere.value, anywhere.agreement) == (None, 1.1, "not judged")
    assert "look alike wherever they fall" in anywhere.reason
    robust = found["Robust to noise"]
    assert (robust.measured, robust.value) == (0, None)
    assert re.findall(r"[\d.]+", robust.reason) == ["9", "50"]
