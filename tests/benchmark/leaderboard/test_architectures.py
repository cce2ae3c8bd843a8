"""The best pipeline of each architecture, and how sure that is: recomputed from the record."""

import math

import pandas as pd
import pytest

from benchmark import datasets
from benchmark.leaderboard.architectures import architectures
from benchmark.leaderboard.board import board_of, build
from benchmark.leaderboard.summaries import best_per_architecture_table, tally
from benchmark.metrics.score import METRICS
from benchmark.results.store import PUBLISHED, Store


def row(model, rms, *, unit=0, dataset="d", bound=1.0, se=0.01, **more):
    ratio = None if rms is None else rms / bound
    return {
        "dataset": dataset, "condition": "nominal", "extractor": "e", "model": model, "unit": unit,
        "dataset_version": 1, "detector": "PD", "mask": "M", "half_fov_deg": None,
        **dict.fromkeys(METRICS), "rms_deg": rms, "bound_deg": bound, "over_bound": ratio,
        "over_bound_se": se, "availability": 1.0, **more,
    }  # fmt: skip


def units(model, *errors, **more):
    return [row(model, error, unit=number, **more) for number, error in enumerate(errors)]


def one(*rows):
    (found,) = architectures(build(rows))
    return found


@pytest.fixture(scope="module")
def record():
    """Rows of the files themselves under the first condition of each data set, of all units."""
    frames = []
    for name in datasets.names():
        preset = datasets.get(name)
        frame = pd.read_csv(PUBLISHED / "scores" / f"{name}.csv")
        frame = frame[frame["condition"] == preset.conditions[0]]
        frames.append(frame.assign(dataset=name, detector=preset.detector, mask=preset.mask))
    return pd.concat(frames, ignore_index=True)


@pytest.fixture(scope="module")
def found():
    return {(r["detector"], r["mask"]): r for r in architectures(board_of(Store(PUBLISHED)))}


def leading(record, architecture):
    """Scores of the standard unit on the data set of the least error, least error first."""
    of_it = record[(record["detector"] == architecture[0]) & (record["mask"] == architecture[1])]
    standard = of_it[(of_it["unit"] == 0) & of_it["rms_deg"].notna()]
    standard = standard[standard["availability"] >= 0.95].sort_values("rms_deg", kind="stable")
    return of_it, standard[standard["dataset"] == standard["dataset"].iloc[0]]


def test_every_architecture_has_its_best_pipeline_and_its_runner_up(record, found):
    assert set(found) == set(zip(record["detector"], record["mask"], strict=True))
    for architecture, answer in found.items():
        of_it, standard = leading(record, architecture)
        best, runner_up = standard.iloc[0], standard.iloc[1] if len(standard) > 1 else None
        assert answer["datasets"] == sorted(of_it["dataset"].unique())
        for name in ("dataset", "rms_deg", "bound_deg", "over_bound", "over_bound_se"):
            assert answer[name] == best[name], (architecture, name)
        if runner_up is not None:
            assert answer["runner_up_rms_deg"] == runner_up["rms_deg"], architecture


def test_how_sure_a_best_pipeline_is_follows_from_samples_and_units(record, found):
    ties = 0
    for architecture, answer in found.items():
        of_it, standard = leading(record, architecture)

        def errors(place, of_it=of_it, answer=answer):
            same = (of_it[["extractor", "model"]] == place).all(axis=1)
            same &= of_it["dataset"] == answer["dataset"]
            return of_it[same].sort_values("unit")["rms_deg"].to_numpy()

        mine = errors([answer["extractor"], answer["model"]])
        assert (answer["others_low_deg"], answer["others_high_deg"]) == (
            mine[1:].min(),
            mine[1:].max(),
        )
        if len(standard) == 1:
            assert (answer["tie"], answer["units_ahead"]) == (False, None)
            continue
        theirs = errors([answer["runner_up_extractor"], answer["runner_up_model"]])
        first, second = standard.iloc[0], standard.iloc[1]
        apart = second["over_bound"] - first["over_bound"]
        alike = apart <= 2.0 * math.sqrt(first["over_bound_se"] ** 2 + second["over_bound_se"] ** 2)
        overlap = mine.min() <= theirs.max() and theirs.min() <= mine.max()
        assert (answer["tie_by_samples"], answer["tie_by_units"]) == (alike, overlap), architecture
        assert answer["tie"] == (alike or overlap)
        assert (answer["units_ahead"], answer["units_compared"]) == ((mine < theirs).sum(), 5)
        ties += answer["tie"]
    assert 0 < ties < len(found)


def test_of_several_data_sets_the_one_with_the_least_error_counts():
    near = [row("a", 3.0, bound=2.9)]
    far = [row("b", 2.0, bound=0.1, dataset="e")]
    silent = [row("c", 0.1, dataset="f", availability=0.5)]
    found = one(*near, *far, *silent)
    assert (found["dataset"], found["model"], found["datasets"]) == ("e", "b", ["d", "e", "f"])
    assert (found["runner_up_model"], found["tie"], found["others_low_deg"]) == (None, False, None)


def test_a_runner_up_is_a_tie_within_two_standard_errors_of_the_difference():
    assert one(row("a", 2.0, se=0.03), row("b", 2.09, se=0.04))["tie_by_samples"]
    apart = one(row("a", 2.0, se=0.03), row("b", 2.11, se=0.04))
    assert (apart["tie"], apart["tie_by_samples"]) == (False, False)
    assert not one(row("a", 2.0, se=None), row("b", 2.0, se=None))["tie"], "nothing is known"


def test_a_runner_up_is_a_tie_where_units_overlap_even_if_it_loses_on_each():
    found = one(*units("a", 2.0, 3.0, 4.0), *units("b", 2.5, 3.5, 4.5))
    assert (found["tie_by_units"], found["tie_by_samples"]) == (True, False)
    assert (found["units_ahead"], found["units_compared"]) == (3, 3)
    assert (found["others_low_deg"], found["others_high_deg"]) == (3.0, 4.0), "not the standard's"
    parted = one(*units("a", 2.0, 3.0), *units("b", 3.5, 4.5))
    assert not parted["tie"]


def test_one_that_answers_too_seldom_ties_with_none_that_answers():
    found = one(*units("a", 2.0, 2.0), *units("b", 2.0, 2.0, availability=0.9))
    assert (found["runner_up_model"], found["tie"]) == ("b", False)


def test_an_architecture_without_any_error_stands_there_with_nothing():
    found = one(row("a", None))
    assert (found["extractor"], found["rms_deg"], found["tie"]) == (None, None, False)
    assert "none has an error" in best_per_architecture_table([found])
    assert "0 within 10" in tally([found])


def test_the_markdown_table_has_a_row_an_architecture_with_the_numbers(found):
    lines = best_per_architecture_table(found.values()).splitlines()
    assert len(lines) == 2 + len(found)
    assert {line.count("|") for line in lines} == {lines[0].count("|")}
    for line, answer in zip(lines[2:], found.values(), strict=True):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        assert cells[0] == f"{answer['detector']}, {answer['mask']}"
        assert cells[1].split(" (")[0] == f"{answer['extractor']} + {answer['model']}"
        assert ("it answers)" in cells[1]) == (answer["finer_model"] is not None)
        assert float(cells[3].rstrip("=")) == pytest.approx(answer["rms_deg"], rel=0.005)
        assert cells[3].endswith("=") == answer["tie"]
        assert float(cells[4].split(" ± ")[0]) == pytest.approx(answer["over_bound"], rel=0.005)


def test_what_errs_far_less_but_answers_too_seldom_is_named_beside_the_best():
    """A grid that is read surely on part of its field: neither hidden, nor first."""
    seldom = row("b", 0.1, dataset="e", availability=0.7)
    found = one(row("a", 2.0), seldom, row("c", 0.05, availability=0.4))
    assert (found["model"], found["finer_model"], found["finer_dataset"]) == ("a", "b", "e")
    assert (found["finer_rms_deg"], found["finer_availability"]) == (0.1, 0.7)
    assert "b: 0.100 deg on the 70 % it answers" in best_per_architecture_table([found])
    assert one(row("a", 0.25), seldom)["finer_model"] is None, "not three times as fine"
    assert one(seldom)["finer_model"] is None, "it is what stands there"
