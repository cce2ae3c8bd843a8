"""/v1/datasets/{name} and its picture: the card with bounds and hashes, drawn once."""

import pytest

from api.server.app import create_app
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark import datasets
from benchmark.datasets.pins import Pin
from benchmark.results.components import Components
from benchmark.results.store import Store

NAME = "cmos-single-aperture"


@pytest.fixture(scope="module")
def pinned(tmp_path_factory, client_of):
    """A service whose published pins are two, one of them of another version."""
    directory = tmp_path_factory.mktemp("published")
    pins = [
        Pin(NAME, condition, "test", version, 400, 32 * letter, 32 * "c", 400, bound, bound)
        for condition, version, letter, bound in (
            ("nominal", datasets.get(NAME).version, "a", 0.25),
            ("hot", 99, "b", 0.5),
        )
    ]
    Store(directory).write({}, pins, Components())
    return client_of(create_app(Knowledge(Measurements(directory))))


def test_pins_of_the_version_there_is_give_hash_and_bound(pinned):
    card = pinned.get(f"/v1/datasets/{NAME}").json()
    assert card["bounds"] == {"nominal": 0.25}
    rows = {(row["condition"], row["split"]): row for row in card["data"]}
    assert rows["nominal", "test"] == {
        "condition": "nominal",
        "split": "test",
        "samples": 400,
        "data_hash": "a" * 32,
        "bound_deg": 0.25,
    }
    assert rows["hot", "test"]["data_hash"] is None
    assert rows["nominal", "calibration"]["data_hash"] is None
    table = pinned.table(f"/v1/datasets/{NAME}")
    assert [row["data_hash"] for row in table] == [row["data_hash"] or "" for row in card["data"]]


@pytest.mark.slow
def test_realism_has_a_row_for_every_dataset_and_board_and_card_name_idealisations(atlas):
    rows = atlas.get("/v1/realism").json()["datasets"]
    assert [row["dataset"] for row in rows] == list(datasets.names())
    boards = {board["name"]: board for board in atlas.get("/v1/leaderboard").json()["datasets"]}
    for row in rows:
        assert bool(row["sensors"]) is (row["idealisation"] is None)
        assert boards[row["dataset"]]["idealisation"] == row["idealisation"]
        card = datasets.get(row["dataset"]).card()["represents"]
        assert card["idealisation"] == row["idealisation"]
    (one,) = atlas.get("/v1/realism?dataset=ccd-n-slit").json()["datasets"]
    assert one["sensors"][0]["accuracy_rms_deg"] == pytest.approx(0.08 / 3)
    problem = atlas.get("/v1/realism?dataset=ccd-n-slits").json()
    assert problem["errors"][0]["nearest"] == "ccd-n-slit"
