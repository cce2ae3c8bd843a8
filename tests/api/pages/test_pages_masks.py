"""Masks of the Sun's image: the experiment's table, its plot, and its direction's verdict."""

from __future__ import annotations

import json

from benchmark.results.store import PUBLISHED
from tests.api.conftest import Client


def test_right_and_wrong_answers_of_every_method_are_a_row_of_the_csv(atlas: Client) -> None:
    boards = json.loads((PUBLISHED / "segmentation.json").read_text("utf-8"))["boards"]
    counts = []
    for board in boards:
        odd = [k for k, unit in enumerate(board["units"]) if unit % 2]
        for fault in board["faults"]:
            for one in fault["methods"]:
                right, answered = (sum(one[name][k] for k in odd) for name in ("found", "answered"))
                named = board["dataset"], fault["fault"], one["method"]
                counts.append((*named, str(right), str(answered - right)))
    table = atlas.table("/experiments/segmentation")
    names = ("dataset", "fault", "method", "right", "wrong")
    assert [tuple(row[name] for name in names) for row in table] == counts


def test_the_direction_of_masks_shows_its_verdict_and_plot(atlas: Client) -> None:
    page = atlas.get("/directions", accept="text/html").text
    assert "/experiments/segmentation/segmentation.svg" in page
    drawn = atlas.get("/experiments/segmentation/segmentation.svg").text
    assert all(name in drawn for name in ("cmos-encoded", "cmos-l-slit", "dirt-laser"))
    (one,) = (one for one in atlas.get("/v1/directions").json()["items"] if one["id"] == "D11")
    assert one["verdict"] != "not tried"
    assert one["experiment"] == "segmentation"
