"""Gap, trade-off and robustness: the drawing, the table and the record have the same numbers."""

from __future__ import annotations

import math
import re
import statistics
from typing import Any

import pytest

from api.figures.robustness import WORST
from api.figures.trade_off import AXES
from benchmark.metrics.intervals import share_interval
from survey_data.products import built_sensors

GAP, TRADE_OFF, ROBUSTNESS = (f"/v1/figures/{n}" for n in ("gap", "trade-off", "robustness"))


def document(atlas: Any, url: str) -> Any:
    answer = atlas.get(url)
    assert answer.status_code == 200, answer.text
    return answer.json()


def drawn(atlas: Any, url: str) -> list[Any]:
    """Return the traces as Plotly has them; it refuses what it does not know."""
    import plotly.graph_objects as go

    return list(go.Figure(document(atlas, f"{url}{'&' if '?' in url else '?'}format=plotly")).data)


def marks(traces: Any, name: str) -> list[tuple[Any, Any]]:
    trace = next(one for one in traces if one.name == name)
    return list(zip(trace.x, trace.y, strict=True))


def test_every_mark_of_the_gap_is_a_number_of_its_row(atlas: Any) -> None:
    items = document(atlas, GAP)["items"]
    traces = drawn(atlas, GAP)
    label = {id(row): f"{row['detector']} + {row['mask']}" for row in items}
    for name, column in (
        ("in flight", "flight_error_deg"),
        ("own error", "own_error_deg"),
        ("bound", "bound_deg"),
    ):
        wanted = [(row[column], label[id(row)]) for row in items if row[column] is not None]
        assert marks(traces, name) == wanted
        assert len(wanted) > 20
    for name, column in (("study", "study_rms_deg"), ("product", "product_rms_deg")):
        wanted = [(value, label[id(row)]) for row in items for value in row[column]]
        assert marks(traces, f"reported by a {name}") == wanted
    flown = [row for row in items if row["flight_error_deg"]]
    bars = next(one for one in traces if one.name == "in flight").error_x
    ends = [
        x + up for x, up in zip((r["flight_error_deg"] for r in flown), bars.array, strict=True)
    ]
    assert ends == pytest.approx([row["flight_high_deg"] for row in flown])


def test_the_gap_counts_what_comes_near_the_bound(atlas: Any) -> None:
    rows = [
        row for row in document(atlas, GAP)["items"] if row["own_error_deg"] and row["bound_deg"]
    ]
    near = [row for row in rows if row["own_error_deg"] <= 2.0 * row["bound_deg"]]
    page = atlas.get("/figures/gap", accept="text/html").text
    assert f"within 2 times the bound for {len(near)} of {len(rows)}." in page


def test_sentences_of_the_gap_count_its_rows(atlas: Any) -> None:
    found = document(atlas, GAP)
    rows, said = found["items"], " ".join(found["text"])
    reported = [min(row["study_rms_deg"] + row["product_rms_deg"], default=None) for row in rows]
    flown = [row["flight_error_deg"] for row in rows]
    counts = (len(rows), *(sum(value is not None for value in of) for of in (reported, flown)))
    assert said.startswith(
        "Architectures: {}, of which {} have a reported accuracy and {} are flown".format(*counts)
    )
    both = [(r, f) for r, f in zip(reported, flown, strict=True) if r is not None and f is not None]
    worse, better = sum(r > f for r, f in both), sum(r < f for r, f in both)
    assert f"Of {len(both)} with both, for {worse} the best reported sensor errs more" in said
    assert f"for {better} the report is the smaller" in said
    times = [r["flight_error_deg"] / r["own_error_deg"] for r in rows if r["flight_error_deg"]]
    ends = re.search(
        r"in flight is ([\d.]+) to ([\d.]+) times the own error, median ([\d.]+)", said
    )
    assert ends is not None
    wanted = (min(times), max(times), statistics.median(times))
    assert [float(one.rstrip(".")) for one in ends.groups()] == pytest.approx(wanted, rel=0.01)


def test_the_gap_says_what_the_answer_says(atlas: Any) -> None:
    rows = {(row["detector"], row["mask"]): row for row in document(atlas, GAP)["items"]}
    for one in document(atlas, "/v1/recommendations?limit=100")["architectures"]:
        row = rows[one["detector"], one["mask"]]
        measured = (one["best"] or {}).get("measured") or {}
        for name in ("flight_error_deg", "own_error_deg", "bound_deg", "dataset", "model"):
            assert row[name] == measured.get(name)
        smallest = [r["rms_deg"] for r in one["reports"] if r["rms_deg"] is not None]
        if smallest:
            assert min(row["study_rms_deg"] + row["product_rms_deg"]) <= min(smallest)


@pytest.mark.parametrize("level", ["flight", "own", "bound", "reported"])
def test_the_gap_is_ordered_by_a_level(atlas: Any, level: str) -> None:
    rows = document(atlas, f"{GAP}?level={level}")["items"]
    column = "bound_deg" if level == "bound" else f"{level}_error_deg"
    reported = level == "reported"
    values = [
        min(row["study_rms_deg"] + row["product_rms_deg"], default=None)
        if reported
        else row[column]
        for row in rows
    ]
    known = [value for value in values if value is not None]
    assert values == sorted(known) + [None] * (len(values) - len(known))


@pytest.mark.parametrize("across", ["field", "height", "poses", "latency", "mass"])
def test_marks_of_the_trade_off_are_its_rows(atlas: Any, across: str) -> None:
    found = document(atlas, f"{TRADE_OFF}?across={across}")
    items = found["items"]
    column, sign = AXES[across][0], -1 if across == "field" else 1
    traces = drawn(atlas, f"{TRADE_OFF}?across={across}")
    points = [mark for trace in traces for mark in zip(trace.x, trace.y, strict=True)]
    assert sorted(points) == sorted((row[column], row["error_deg"]) for row in items)
    worth = [(sign * row[column], row["error_deg"]) for row in items]
    for row, (cost, error) in zip(items, worth, strict=True):
        beaten = any(c <= cost and e <= error and (c, e) != (cost, error) for c, e in worth)
        assert (row["status"] == "frontier") == (not beaten)
    ends = sorted((r["error_deg"], r["name"]) for r in items if r["status"] == "frontier")
    said = " ".join(found["text"])
    assert f"frontier runs from {ends[0][1]} (" in said
    assert f" to {ends[-1][1]} (" in said


def test_errors_of_the_trade_off_are_those_of_the_leaderboard(atlas: Any) -> None:
    name = "qpd-single-aperture"
    rows = document(atlas, f"{TRADE_OFF}?level=own&across=latency&dataset={name}")["items"]
    board = document(atlas, f"/v1/leaderboard/{name}?condition=nominal&limit=500")["items"]
    of = {f"{name}:{row['extractor']}:{row['model']}": row for row in board}
    assert len(rows) > 5
    for row in rows:
        there = of[row["name"]]
        assert row["error_deg"] == there["own_error_deg"]
        assert (row["latency_us"], row["low_deg"]) == (there["latency_us"], there["low_deg"])
        if there["group"] == 1:  # not separated from the leader by the board's own test
            assert row["status"] != "dominated"


def test_power_and_mass_are_those_that_products_state(atlas: Any) -> None:
    rows = {row["name"]: row for row in document(atlas, f"{TRADE_OFF}?across=mass")["items"]}
    stated = {one.name: one for one in built_sensors().values()}
    shown = [name for name in rows if name in stated]
    assert len(shown) > 10
    for name in shown:
        assert rows[name]["mass_g"] == stated[name].mass_g
        assert rows[name]["error_deg"] == pytest.approx(stated[name].accuracy_rms_deg, rel=1e-3)


def test_sentences_of_robustness_are_of_its_cells(atlas: Any) -> None:
    found = document(atlas, ROBUSTNESS)
    first = [row for row in found["items"] if row["condition"] == "nominal"]
    near = sum(row["over_bound"] is not None and row["over_bound"] <= 2.0 for row in first)
    names = {row["name"] for row in found["items"]}
    assert (
        f"nominal conditions {near} of {len(names)} extractors are within 2 times"
        in (found["text"][0])
    )
    found = document(atlas, f"{ROBUSTNESS}?hazard=albedo")
    worst = [row for row in found["items"] if row["condition"] == WORST]
    known = [row for row in worst if row["over_bound"] is not None]
    near = sum(row["over_bound"] <= 2.0 for row in known)
    assert found["text"][-1].startswith(f"Of {len(worst)}, {near} are within 2 times the bound")
    assert f": {known[0]['name']} (" in found["text"][-2]


def test_cells_of_the_heat_map_are_the_rows(atlas: Any) -> None:
    asked = f"{ROBUSTNESS}?hazard=albedo&detector=CMOS"
    grey, shaded = drawn(atlas, asked)
    for row in document(atlas, asked)["items"]:
        at = list(shaded.y).index(row["name"]), list(shaded.x).index(row["condition"])
        z, said = shaded.z[at[0]][at[1]], grey.text[at[0]][at[1]]
        assert (said == "×") == (row["state"] == "below 95 %")
        if row["over_bound"] is None:
            assert z is None or math.isnan(z)
        else:
            assert 10**z == pytest.approx(row["over_bound"])
            assert (row["state"], row["answered"] > 0) == ("measured", True)
        assert len(row["datasets"]) == row["data_sets"]
        assert (row["state"] == "untested") == (row["data_sets"] == 0)


def test_a_cell_of_one_data_set_is_its_score(atlas: Any) -> None:
    rows = document(atlas, f"{ROBUSTNESS}?detector=CCD&mask=V-Slit&condition=albedo")["items"]
    board = document(atlas, "/v1/leaderboard/ccd-v-slit?limit=500")["items"]
    best = {
        r["extractor"]: r for r in board if r["condition"] == "nominal" and r["best_of_extractor"]
    }
    scores = {(r["condition"], r["extractor"], r["model"]): r["over_bound"] for r in board}
    checked = 0
    for row in rows:
        model = best[row["name"]]["model"] if row["name"] in best else None
        score = scores.get((row["condition"], row["name"], model))
        if row["condition"] != WORST and score is not None and row["over_bound"] is not None:
            assert row["over_bound"] == score
            checked += 1
    assert checked > 5


def test_the_worst_is_over_data_sets_that_have_all_that_is_asked(atlas: Any) -> None:
    found = document(atlas, f"{ROBUSTNESS}?hazard=saturation&hazard=glare")
    worst = [row for row in found["items"] if row["condition"] == WORST]
    assert {name for row in worst for name in row["datasets"]} == {"ccd-lens", "cmos-lens"}
    assert found["together"] == ["saturation-clouds"]
    for one in found["best"]:
        board = document(atlas, f"/v1/leaderboard/{one['dataset']}?limit=500")["items"]
        scores = [
            r["over_bound"]
            for r in board
            if r["condition"] in ("glare", "saturation-clouds") and r["extractor"] == one["name"]
        ]
        assert one["over_bound"] in scores
    none = document(atlas, f"{ROBUSTNESS}?condition=saturated&condition=stray-light")
    assert "No data set has saturated and stray-light" in none["text"][0]


def test_two_extractors_are_compared_on_every_board_that_has_both(atlas: Any) -> None:
    found = document(atlas, f"{ROBUSTNESS}?compare=mirror&compare=bctm")
    every, first = found["pairwise"]
    outcomes = [duel["outcome"] for duel in found["duels"]]
    assert [every[name] for name in ("wins", "ties", "losses", "neither")] == [
        outcomes.count(name) for name in ("win", "tie", "loss", "neither")
    ]
    low, high = share_interval(every["wins"], every["wins"] + every["losses"])
    assert (every["share_low"], every["share_high"]) == pytest.approx((low, high), rel=1e-4)
    assert every["data_sets"] == first["data_sets"] == len({d["dataset"] for d in found["duels"]})
    assert (every["first"], every["second"]) == ("mirror", "bctm")
    boards = sum(every[name] for name in ("wins", "ties", "losses", "neither"))
    share = 100.0 * every["wins"] / (every["wins"] + every["losses"])
    better, counted = found["text"][:2]
    assert counted.startswith(f"All conditions, {boards} boards of {every['data_sets']} data sets")
    assert f"mirror has the smaller error on {every['wins']} ({share:.0f} % of" in counted
    assert f"bctm on {every['losses']}; equal within 3 % on {every['ties']}; on" in counted
    verdict = "neither is shown better"
    low, high = every["ratio_low"] or 0.0, every["ratio_high"] or math.inf
    if high < 1.0 or low > 1.0:
        verdict = f"{'mirror' if high < 1.0 else 'bctm'} is better"
    assert better.startswith(f"All conditions: {verdict}. ")
    _, points = drawn(atlas, f"{ROBUSTNESS}?compare=mirror&compare=bctm")
    known = [(d["ratio"], d["dataset"]) for d in found["duels"] if d["ratio"]]
    assert list(zip(points.x, points.y, strict=True)) == known


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("robustness?compare=mirror", "two different names"),
        ("robustness?compare=mirror&compare=bctn", "bctm"),
        ("trade-off?across=power&level=own", "one of field, height"),
        ("trade-off?across=latency&level=reported", "one of field, power, mass"),
        ("trade-off?select=nobody", "a row's name"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_what_can(atlas: Any, query: str, said: str) -> None:
    answer = atlas.get(f"/v1/figures/{query}")
    assert answer.status_code == 422
    assert said in answer.json()["detail"]
