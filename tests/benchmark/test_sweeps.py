"""Sweeps: what is measured, stored, renewed and compared."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import ClassVar
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from algorithms.contract import FeatureKind, Observation
from algorithms.discovery import discover_extractors
from benchmark import sweep_pictures, sweep_plan, sweep_tables, sweeps
from benchmark.reference_series import SWEEPS
from benchmark.store import StoreError


@dataclass(frozen=True)
class Plain:
    """Balances by the closed form."""

    name: ClassVar[str] = "plain"
    taxonomy: ClassVar[str] = "Voltage balance"
    studies: ClassVar[tuple[str, ...]] = ()
    labels: ClassVar[tuple[str, ...]] = ()
    origin: ClassVar[str] = "survey"
    version: ClassVar[int] = 1
    observation: ClassVar[Observation] = Observation.CURRENTS
    kind: ClassVar[FeatureKind] = FeatureKind.BALANCE
    needs: ClassVar[tuple[str, ...]] = ()
    features: ClassVar[tuple[str, ...]] = ("s_a", "s_b")

    @classmethod
    def for_sensor(cls, geometry):
        return cls()

    def extract(self, observations):
        q1, q2, q3, q4 = observations.T
        both = np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4])
        return both / observations.sum(axis=1, keepdims=True)


class Broken(Plain):
    name = "broken"

    def extract(self, observations):
        raise RuntimeError("no light")


class Spots(Plain):
    name = "spots-of-readings"
    kind = FeatureKind.SPOT


FEW = {c.name: c for c in (Plain, Broken, Spots)}


def quiet(*_):
    pass


@pytest.fixture
def made(tmp_path):
    return tmp_path, sweeps.update(tmp_path, 1, quiet, extractors=FEW)


def test_points_are_measured_failures_named_and_misfits_listed(made):
    directory, swept = made
    rows = sweeps.read(directory)
    states = {name: {r["status"] for r in rows if r["extractor"] == name} for name in FEW}
    assert states == {"plain": {"ok"}, "broken": {"failed"}, "spots-of-readings": {"refused"}}
    assert swept.planned == swept.computed == 2 * len(sweep_plan.SERIES["quadrants"].settings())
    assert {reason for _, reason in swept.failed} == {"RuntimeError: no light"}
    listed = sweep_tables.unmeasured(rows)
    assert listed == [
        ("", "spots-of-readings", "no reference series of currents that are read as spot")
    ]


def test_the_closed_form_of_balances_is_at_the_bound(made):
    found = [
        row["over_bound"]
        for row in sweeps.read(made[0])
        if row["extractor"] == "plain" and row["sweep"] == "noise"
    ]
    assert len(found) == 7
    assert found == pytest.approx([1.0] * 7, abs=0.08)


def test_what_is_current_stays_and_failures_are_tried_again(made):
    directory, swept = made
    before = (directory / sweeps.FILE).read_bytes()
    again = sweeps.update(directory, 1, quiet, extractors=FEW)
    assert again.computed == swept.computed // 2 == len(again.failed)
    assert (directory / sweeps.FILE).read_bytes() == before
    assert sweeps.outdated(directory, FEW) == []
    less = sweeps.update(directory, 1, quiet, extractors={"plain": Plain})
    assert less.computed == 0
    assert {row["extractor"] for row in sweeps.read(directory)} == {"plain"}


def test_workers_and_what_was_there_before_do_not_change_a_byte(tmp_path):
    known = discover_extractors()
    some = {name: known[name] for name in ("voltage-balance", "direct", "escm-wta")}
    one, two, grown = (tmp_path / name for name in ("one", "two", "grown"))
    sweeps.update(one, 1, quiet, extractors=some)
    sweeps.update(two, 2, quiet, extractors=some)
    sweeps.update(grown, 1, quiet, extractors={"direct": some["direct"]})
    assert sweeps.update(grown, 1, quiet, extractors=some).computed < 60
    text = (one / sweeps.FILE).read_bytes()
    assert (two / sweeps.FILE).read_bytes() == text
    assert (grown / sweeps.FILE).read_bytes() == text


def test_a_changed_key_and_a_missing_point_are_named(made):
    directory, _ = made
    path = directory / sweeps.FILE
    lines = path.read_text().splitlines()
    row = json.loads(lines[0]) | {"key": "0" * 32}
    path.write_text("\n".join([json.dumps(row), *lines[2:]]) + "\n")
    found = sweeps.outdated(directory, FEW)
    assert sorted(state for _, state in found) == ["absent", "of other code"]


def test_a_number_that_moved_is_told_beyond_the_tolerance_only(made):
    rows = [row for row in sweeps.read(made[0]) if row["status"] == "ok"]
    near = [{**row, "rms": row["rms"] * 1.0005, "key": "other"} for row in rows]
    assert list(sweeps.differences(rows, near)) == []
    far = [{**rows[0], "rms": rows[0]["rms"] * 1.01}, *rows[1:]]
    (found,) = sweeps.differences(rows, far)
    assert found[0] == f"{sweeps.point_of(rows[0])}/rms"
    assert [place for place, *_ in sweeps.differences(rows[1:], rows)] == [
        f"{sweeps.point_of(rows[0])}/row"
    ]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("{", "not JSON"),
        ("[]", "not a row"),
        ('{"series":"a"}', "not a row"),
    ],
)
def test_a_line_that_is_no_row_is_named(tmp_path, line, says):
    (tmp_path / sweeps.FILE).write_text(line + "\n")
    with pytest.raises(StoreError, match=rf"line 1: {says}"):
        sweeps.read(tmp_path)


def test_a_row_of_another_version_or_there_twice_is_refused(made):
    path = made[0] / sweeps.FILE
    line = path.read_text().splitlines()[0]
    path.write_text(f"{line}\n{line}\n")
    with pytest.raises(StoreError, match="there twice"):
        sweeps.read(made[0])
    path.write_text(json.dumps(json.loads(line) | {"sweep_version": 0}) + "\n")
    with pytest.raises(StoreError, match="written under version 0"):
        sweeps.read(made[0])


def test_tables_are_read_back_cell_by_cell(made):
    rows = sweeps.read(made[0])
    as_csv = sweep_tables.from_csv(sweep_tables.to_csv(rows))
    assert as_csv == sweep_tables.cells(rows)
    as_markdown = sweep_tables.from_markdown("\n".join(sweep_tables.to_markdown(rows)))
    shown = {
        (cell, column): text
        for table in sweep_tables.tables(rows)
        for _, values in table.rows
        for cell, column, text in values
    }
    assert as_markdown == shown
    assert ("quadrants/noise/50/plain", "over_bound") in shown
    assert shown["quadrants/noise/50/broken", "over_bound"] == "-"


def test_pictures_are_the_same_every_time_and_well_formed(made):
    rows = sweeps.read(made[0])
    for sweep in sweep_pictures.DRAWN:
        text = sweep_pictures.picture(rows, sweep)
        assert text == sweep_pictures.picture(rows, sweep)
        ET.fromstring(text)
    drawn = sweep_pictures.picture(rows, "noise")
    assert drawn.count("<circle") == 7 + 2  # the legend's two
    assert "nothing found" in drawn  # the broken one's panel
    with pytest.raises(ValueError, match="sweep must be one of noise, size, phase"):
        sweep_pictures.picture(rows, "pedestal")


def test_every_method_of_the_survey_has_a_noise_sweep():
    """Accept point: all 19 values of the taxonomy, error and bound from SNR 5 upwards."""
    known = discover_extractors()
    plan = sweep_plan.planned(known)
    swept = {known[p.extractor].taxonomy for p in plan.settings if p.sweep == "noise"}
    implemented = {extractor.taxonomy for extractor in known.values()}
    assert implemented <= swept
    for point, reason in plan.refused.items():
        assert reason, point
    assert {point.sweep for point in plan.settings} == set(SWEEPS)
