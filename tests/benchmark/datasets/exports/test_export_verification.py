"""Forged exports, whose digests all hold, are found by what the data set itself makes."""

from __future__ import annotations

import json
import random
import re
import shutil
from pathlib import Path

import pytest

from benchmark.datasets import export_verification
from benchmark.datasets.export import CARD, ExportError, export
from benchmark.datasets.export_verification import verify
from benchmark.results.store import PUBLISHED, Store
from tools.faults import forging

PINS = Store(PUBLISHED).pins()
FORGERIES = (
    forging._numbers,
    forging._bounds,
    forging._flags,
    forging._rows,
    forging._readings,
    forging._said,
    forging._picture,
    forging._left_out,
    forging._another_version,
    forging._another_name,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("export") / "out"
    return export("pd-slit", out, conditions=["nominal"], n=6, pins=PINS).directory


@pytest.fixture
def copy(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "copy"))


@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda one: one.__name__.strip("_"))
def test_a_forgery_whose_digests_fit_is_found(copy, forgery):
    card = json.loads((copy / CARD).read_text())
    forgery(random.Random(3), copy, card)
    forging._fit(copy, card)
    assert len(verify(copy, pins=PINS)) >= 1


def test_fitting_digests_alone_changes_nothing(copy):
    forging._fit(copy, json.loads((copy / CARD).read_text()))
    assert verify(copy, pins=PINS) == []


def test_what_differs_is_named_by_its_sample(copy):
    path = copy / "nominal" / "test.npz"

    def change(arrays):
        arrays["bound_alpha_deg"][4] *= 1000

    forging._changed(path, change)
    forging._fit(copy, json.loads((copy / CARD).read_text()))
    ((where, what),) = verify(copy, pins=PINS)
    assert where == "nominal/test.npz"
    assert what.startswith("bound_alpha_deg[4] is ")


def test_pins_tell_without_making_anything_again(copy, monkeypatch):
    monkeypatch.setattr(export_verification, "export", None)
    forging._changed(copy / "nominal" / "test.npz", lambda a: a["observations"].__imul__(1.001))
    forging._fit(copy, json.loads((copy / CARD).read_text()))
    ((_, what),) = verify(copy, pins=PINS, anew=False)
    assert re.match(r"hash\D* 4 \D", what)
    assert verify(copy, anew=False) == []  # no pins, and nothing made again


def test_a_card_that_asks_for_nothing_known_is_refused(copy):
    card = json.loads((copy / CARD).read_text())
    for asked in ({"conditions": [], "splits": []}, {"first_samples": "six"}):
        forging._fit(copy, {**card, "exported": {**card["exported"], **asked}})
        ((where, what),) = verify(copy)
        assert (where, what[:9]) == (CARD, "exported:")
    forging._fit(copy, {**card, "exported": {}})
    with pytest.raises(ExportError, match="not the card of an export"):
        verify(copy)


def test_an_archive_that_unpacks_to_more_than_its_card_says_is_not_unpacked(copy):
    path = copy / "nominal" / "test.npz"
    described = {
        name: {"dtype": array.dtype.str, "shape": [1]}
        for name, array in export_verification.read_archive(path).items()
    }
    assert "unpacks to more" not in export_verification._read(path, described)
    forging._changed(path, lambda a: a.update(sun=a["sun"].repeat(1000, axis=0)))
    assert "unpacks to more" in export_verification._read(path, described)


def test_what_a_card_leaves_out_is_named_but_not_a_hash_that_is_published_for_one_side(copy):
    card = json.loads((copy / CARD).read_text())
    card["mask"] = None
    for entry in card["files"]:
        if "published_data_hash" in entry:
            assert entry["published_data_hash"] is None
            entry["published_data_hash"] = entry["data_hash"]
    forging._fit(copy, card)
    (problem,) = verify(copy, pins=PINS)
    assert problem[0] == CARD
    assert problem[1].startswith("mask is None, ")
