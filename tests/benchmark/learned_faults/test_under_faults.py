"""The network under faults as it is kept: its file, its record, its picture and what is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmark.directions.learned import under_faults
from benchmark.directions.outcomes import read_trials
from benchmark.experiments.learned_faults import LearnedFaults
from benchmark.learned.frames import TRAINING
from benchmark.learned.measure import UNITS
from benchmark.learned.network import Network
from benchmark.learned_faults.curves import NONE_DEG, curve, logs
from benchmark.learned_faults.deep import WEIGHTS, DeepReader
from benchmark.learned_faults.rule import FAULTS
from benchmark.running.experiment import list_due


def test_the_network_is_small_and_learned_from_no_unit_that_is_scored() -> None:
    network = Network.load(WEIGHTS)
    assert WEIGHTS.stat().st_size < 1_000_000
    assert network.card["units"] == [TRAINING.start, TRAINING.stop - 1]
    assert not {*TRAINING} & {*UNITS}


def test_the_network_answers_nothing_on_frames_without_a_sun() -> None:
    network = Network.load(WEIGHTS)
    noise = np.random.default_rng(5).normal(0.0, 2.0, (6, 256, 256))
    dark = np.concatenate([noise, np.zeros((1, 256, 256)), noise[:1] + 30.0])
    found, _ = DeepReader(network, network.card["limits"]).read(dark)
    assert np.isnan(found).all()


@pytest.fixture(scope="module")
def experiment() -> LearnedFaults:
    return LearnedFaults()


def test_the_record_is_of_this_network_and_has_every_fault_and_strength(
    experiment: LearnedFaults,
) -> None:
    assert list_due(experiment) == []
    rows = {row["fault"]: row for row in experiment.rows()}
    assert {fault: tuple(row["strengths"][1:]) for fault, row in rows.items()} == FAULTS
    for row in rows.values():
        for way in row["ways"].values():
            for units in zip(*way.values(), strict=True):
                assert all(len(numbers) == len(UNITS) for numbers in units)
            for answered, far in zip(way["answered"], way["far"], strict=True):
                assert all(a >= f >= 0 for a, f in zip(answered, far, strict=True))


def test_without_a_fault_all_faults_have_the_same_numbers(experiment: LearnedFaults) -> None:
    rows = experiment.rows()
    for way, of in rows[0]["ways"].items():
        for name, numbers in of.items():
            assert all(row["ways"][way][name][0] == numbers[0] for row in rows)


def test_the_table_has_both_ways_at_every_strength(experiment: LearnedFaults) -> None:
    table = experiment.table()
    assert len(table) == sum(2 * (1 + len(of)) for of in FAULTS.values())
    (one,) = (
        row
        for row in table
        if (row["fault"], row["strength"], row["way"]) == ("laser", 0.8, "network")
    )
    (row,) = (row for row in experiment.rows() if row["fault"] == "laser")
    answered = row["ways"]["network"]["answered"][-1]
    assert one["answered"] == pytest.approx(sum(answered) / (row["frames"] * len(UNITS)), abs=1e-5)


def test_the_picture_has_three_panels_a_fault(experiment: LearnedFaults) -> None:
    (draw,) = experiment.pictures().values()
    drawn = draw()
    for fault in FAULTS:
        assert f"{fault}: error of answers, deg" in drawn
        assert f"{fault}: share answered" in drawn
        assert f"{fault}: share of wrong answers" in drawn


def made(network: list[float], answered: int = 100) -> dict[str, Any]:
    """Return a row of three units whose pipeline is off by 1 deg at every strength."""

    def of(errors: list[float], count: int) -> dict[str, Any]:
        return {
            "answered": [[count] * 3] * 2,
            "far": [[0] * 3, [5] * 3],
            "rms_deg": [errors] * 2,
        }

    names = {"dataset": "cmos-encoded", "fault": "rain", "extractor": "a", "model": "b"}
    ways = {"network": of(network, answered), "classical": of([1.0, 1.0, 1.0], 100)}
    return {**names, "frames": 100, "strengths": [0.0, 0.5], "ways": ways}


def test_a_method_that_answers_fewer_than_95_percent_has_the_largest_error() -> None:
    assert logs(made([2.0, 2.0, 2.0], 95), 1) == pytest.approx(np.log([2.0] * 3))
    assert logs(made([2.0, 2.0, 2.0], 94), 1) == pytest.approx(np.log([NONE_DEG] * 3))
    assert curve(made([2.0, 3.0, 9.0]), "network", "rms_deg") == [3.0, 3.0]
    assert curve(made([2.0, 3.0, 9.0], 94), "network", "answered") == [0.94, 0.94]


@pytest.mark.parametrize(
    ("network", "answered", "said"),
    [
        ([0.5, 0.5, 0.51], 100, "errs less in 1 of 1 cases and more in 0"),
        ([2.0, 2.0, 2.1], 100, "errs less in 0 of 1 cases and more in 1"),
        ([0.5, 0.5, 0.5], 90, "errs less in 0 of 1 cases and more in 1"),
        ([1.0, 1.01, 0.99], 100, "errs less in 0 of 1 cases and more in 0"),
    ],
)
def test_the_verdicts_sentence_counts_by_the_limits_of_networks(network, answered, said) -> None:
    text = under_faults([made(network, answered)])
    assert said in text
    assert f"rain 0.5: 5 % (5 %) of all frames, {answered} % (100 %) answered" in text
    assert under_faults([]) == ""


def test_wins_by_the_silence_of_the_pipeline_are_told_apart() -> None:
    row = made([2.0, 2.0, 2.1])
    row["ways"]["classical"]["answered"] = [[100] * 3, [90] * 3]
    text = under_faults([row])
    assert "errs less in 1 of 1 cases" in text
    assert "in 1 of the 1 that is all" in text
    assert "in 0 of the 1 that is all" in under_faults([made([0.5, 0.5, 0.5])])


def test_the_direction_of_networks_is_told_of_faults_beside_its_own_rows() -> None:
    networks = {row["network"] for row in read_trials()["learned"]}
    assert {"heat map", "sscnn", "sscnn under faults"} <= networks
