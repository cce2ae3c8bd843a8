"""The front figure shows the sensors that were built; the guide's claims are reproduced ones."""

from __future__ import annotations

import csv
import dataclasses

import numpy as np
import pytest

from api.docs import front, measured_facts
from survey_data.descriptor import DATA_DIRECTORY


def test_built_sensors_stand_with_their_own_detector_and_mask() -> None:
    """Independent of the figure: rows of the hardware table, read as text."""
    with (DATA_DIRECTORY / "hardware.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["accuracy_deg"]]
    seen = [row for row in rows if row["basis"] == "page"]
    found = front._built()
    assert sum(map(len, found.values())) == len(seen)
    for detector, mask in found:
        beside = [row for row in seen if (row["detector"], row["mask"]) == (detector, mask)]
        assert len(found[detector, mask]) == len(beside)
    assert ("CCD", "Single-Ap.") not in found, "TU Delft's and TNO's are CMOS chips"


def test_every_built_sensor_below_its_bound_is_drawn_open() -> None:
    bounds = {(row["detector"], row["mask"]): row["bound_deg"] for row in front._architectures()}
    below = [
        error
        for place, errors in front._built().items()
        for error in errors
        if error < bounds.get(place, 0.0)
    ]
    (axes,) = front.figure().axes
    drawn = [
        float(error)
        for line in axes.lines
        if (line.get_marker(), line.get_fillstyle()) == ("^", "none")
        for error in np.atleast_1d(line.get_xdata())
    ]
    assert sorted(drawn) == sorted(below)
    assert "below the bound" in axes.get_xlabel()


def test_a_claim_of_the_guide_that_is_not_reproduced_any_more_stops_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    changed = measured_facts.USEFUL[2]
    entries = [
        dataclasses.replace(entry, verdict="refuted") if entry.claim.id == changed else entry
        for entry in measured_facts.ledger()
    ]
    monkeypatch.setattr(measured_facts, "ledger", lambda: entries)
    with pytest.raises(ValueError, match=f"^{changed}: not reproduced any more"):
        measured_facts.reproduced_claims()
