"""The networks that are kept, and what is measured with them."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from benchmark import datasets
from benchmark.experiments.learned import Learned
from benchmark.learned.centres import CentreReader
from benchmark.learned.frames import TRAINING, VALIDATION, Unit
from benchmark.learned.measure import UNITS
from benchmark.learned.network import Network
from benchmark.learned.networks import NETWORKS
from benchmark.learned.plans import CENTRES, SEEDS
from benchmark.learned.record import RECORD
from benchmark.retraining import main
from benchmark.running.experiment import list_due

NAMES = {path.stem for path in NETWORKS.glob("*.npz")}


def test_networks_are_small_and_say_what_they_learned() -> None:
    assert sum(path.stat().st_size for path in NETWORKS.glob("*.npz")) < 2_000_000
    wanted = {f"centres-{of}-{seed}" for of in CENTRES for seed in SEEDS.get(of, (0,))}
    assert wanted < NAMES
    for name in wanted:
        card = Network.load(NETWORKS / f"{name}.npz").card
        assert card["recipe"]["seed"] == int(name.rsplit("-", 1)[1])
        assert card["units"] == [TRAINING.start, TRAINING.stop - 1]
        assert card["framework"].startswith("torch ")


def test_no_unit_is_both_learned_from_and_scored() -> None:
    assert not {*TRAINING, *VALIDATION} & {*range(10), *UNITS}
    assert not {*TRAINING} & {*VALIDATION}


def test_a_kept_network_finds_the_spot_of_a_unit_that_it_has_not_seen() -> None:
    name = "cmos-single-aperture"
    network = Network.load(NETWORKS / f"centres-{name}-0.npz")
    unit = Unit(datasets.get(name).for_unit(50))
    taken = unit.taken(unit.scene(20, "test"), "test")
    found, _ = CentreReader(network, CENTRES[name].look, network.card["limits"]).read(
        taken.corrected
    )
    off = found + taken.origin_px - unit.spot_px(taken.sun)
    assert np.nanmedian(np.abs(off)) < 3.0 * max(network.card["validation_px"])
    assert np.isfinite(found).all(axis=1).mean() > 0.9


def test_a_group_of_networks_that_is_not_there_is_refused_with_those_that_are(capsys) -> None:
    with pytest.raises(SystemExit):
        main(["centres-cmos-lense"])
    assert "no networks 'centres-cmos-lense'; there are centres-" in capsys.readouterr().err


def test_without_pytorch_nothing_begins_and_the_extra_is_named(monkeypatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(SystemExit) as ended:
        main(["centres-cmos-lens"])
    assert ended.value.code == 2
    assert "pip install 'sun-sensor-atlas[learn]'" in capsys.readouterr().err


@pytest.fixture(scope="module")
def experiment() -> Learned:
    return Learned()


def test_the_record_is_of_these_networks(experiment: Learned) -> None:
    assert list_due(experiment) == []


def test_the_table_has_every_way_on_every_unit(experiment: Learned) -> None:
    rows, table = RECORD.read().values(), experiment.table()
    assert len(table) == sum(len(row["errors_deg"]) for row in rows)
    by = {(one["network"], one["dataset"], one["way"]): one for one in table}
    for row in rows:
        for way, errors in row["errors_deg"].items():
            one = by[row["network"], row["dataset"], way]
            assert [one[f"unit_{unit}_deg"] for unit in UNITS] == errors
        for tried in row["trust"]:
            one = by[row["network"], row["dataset"], tried["way"]]
            share = tried["wrong"] / tried["frames"]
            name = f"wrong_{tried['trial'].lower().replace(' ', '_')}"
            assert one[name] == pytest.approx(share, abs=1e-5)


def test_the_picture_has_a_panel_a_network_and_data_set(experiment: Learned) -> None:
    (draw,) = experiment.pictures().values()
    drawn = draw()
    assert all(f"{row['dataset']}, {row['network']}" in drawn for row in experiment.rows())
