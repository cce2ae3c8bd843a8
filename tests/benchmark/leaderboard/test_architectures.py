"""The best pipeline of each architecture, and how sure that is: recomputed from the record."""

import pandas as pd
import pytest

from benchmark import datasets
from benchmark.leaderboard.architectures import architectures
from benchmark.leaderboard.board import build
from benchmark.leaderboard.summaries import best_per_architecture_table, tally
from benchmark.metrics.score import METRICS
from benchmark.results.store import PUBLISHED


def row(model, rms, *, unit=0, dataset="d", bound=1.0, se=0.01, **more):
    ratio = None if rms is None else rms / bound
    return {
        "dataset": dataset, "condition": "nominal", "extractor": "e", "model": model, "unit": unit,
        "dataset_version": 1, "detector": "PD", "mask": "M", "half_fov_deg": None,
        **dict.fromkeys(METRICS), "rms_deg": rms, "rms_all_answers_deg": rms, "bound_deg": bound,
        "over_bound": ratio, "over_bound_se": se, "availability": 1.0, **more,
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
def found(published_board):
    return {(r["detector"], r["mask"]): r for r in architectures(published_board)}


def test_of_several_data_sets_the_one_with_the_least_error_counts():
    near = [row("a", 3.0, bound=2.9)]
    far = [row("b", 2.0, bound=0.1, dataset="e")]
    silent = [row("c", 0.1, dataset="f", availability=0.5)]
    found = one(*near, *far, *silent)
    assert (found["dataset"], found["model"], found["datasets"]) == ("e", "b", ["d", "e", "f"])
    assert (found["runner_up_model"], found["tie"], found["others_low_deg"]) == (None, False, None)


def test_a_runner_up_is_a_tie_where_the_paired_test_does_not_tell_it_apart():
    base = [2.0, 3.0, 4.0, 2.5, 3.5, 2.2]
    alike = one(*units("a", *base), *units("b", *(1.01 * e for e in base)))
    assert (alike["tie"], alike["first_group"]) == (True, 2)
    assert (alike["units_ahead"], alike["units_compared"]) == (6, 6)
    apart = one(*units("a", *base), *units("b", *(1.3 * e for e in base)))
    assert (apart["tie"], apart["first_group"]) == (False, 1)
    assert (apart["others_low_deg"], apart["others_high_deg"]) == (2.2, 4.0), "not the standard's"


def test_one_that_answers_too_seldom_ties_with_none_that_answers():
    found = one(*units("a", 2.0, 2.0), *units("b", 2.0, 2.0, availability=0.9))
    assert (found["runner_up_model"], found["tie"]) == ("b", False)


def test_an_architecture_without_any_error_stands_there_with_nothing():
    found = one(row("a", None))
    assert (found["extractor"], found["rms_deg"], found["tie"]) == (None, None, False)
    assert "none has an error" in best_per_architecture_table([found])
    assert "0 within 10" in tally([found])


def test_what_errs_far_less_but_answers_too_seldom_is_named_beside_the_best():
    """A grid that is read surely on part of its field: neither hidden, nor first."""
    seldom = row("b", 0.1, dataset="e", availability=0.7)
    found = one(row("a", 2.0), seldom, row("c", 0.05, availability=0.4))
    assert (found["model"], found["partial_model"], found["partial_dataset"]) == ("a", "b", "e")
    assert (found["partial_own_error_deg"], found["partial_availability"]) == (0.1, 0.7)
    assert "b: 0.100 deg at 70 %" in best_per_architecture_table([found])
    assert one(row("a", 0.25), seldom)["partial_model"] is None, "not three times as fine"
    assert one(seldom)["partial_model"] is None, "it is what stands there"
