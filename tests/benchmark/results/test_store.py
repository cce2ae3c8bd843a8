"""Results on disk: sorted, canonical, whole or not at all, and clear about what is broken."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fake_results import cell, components, numbers, pin
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from benchmark.metrics.score import METRICS
from benchmark.results import record_manifest
from benchmark.results.csv_tables import StoreError, number, read_csv, text_of, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import Store, UnknownFieldError, pins_text, read_pins

TEXT = st.text(st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp"))).map(
    lambda text: " ".join(text.split())
)


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "results")


def write(store, scores=None, pins=(), known=None):
    store.write(scores or {}, pins, known or components())


def files(store):
    return {
        path.relative_to(store.directory): path.read_bytes()
        for path in store.directory.rglob("*.*")
        if path.is_file()
    }


def test_what_is_written_is_read_back_sorted_whatever_the_order(store, tmp_path):
    scores = {
        cell("b"): numbers(0.25, reason='said "no", twice'),
        cell("a"): numbers(1.0, max_deg=12345.0, p95_deg=1e-7),
        cell("a", "c"): numbers(None, status="failed", reason="RuntimeError: é"),
        cell("a", unit=10): numbers(0.1),
        cell("a", unit=2): numbers(0.2),
    }
    pins = [pin(), pin("calibration")]
    write(store, scores, pins)
    assert store.scores() == scores
    found = [(one.dataset, one.model, one.unit) for one in store.scores()]
    assert found == [("c", "a", 0), ("d", "a", 0), ("d", "a", 2), ("d", "a", 10), ("d", "b", 0)]
    assert store.pins() == {one.place: one for one in pins}
    assert store.components() == components()
    other = Store(tmp_path / "other")
    write(other, dict(reversed(scores.items())), pins[::-1])
    assert files(other) == files(store)
    assert {str(path) for path in files(store)} == {
        "scores/c.csv", "scores/d.csv", "pins.csv", "components.json",
        "checksums-sha256.txt",
    }  # fmt: skip


@settings(deadline=None, derandomize=True)
@given(
    rows=st.lists(
        st.fixed_dictionaries(
            {
                "a": st.none() | st.floats(allow_nan=False, allow_infinity=False),
                "b": st.integers(-(10**9), 10**9).map(float),
                "text": TEXT,
            }
        ),
        max_size=5,
    )
)
def test_a_table_reads_back_every_number_and_word(rows, tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "t.csv"
    path.write_text(text_of(["a", "b", "text"], rows), encoding="utf-8", newline="")
    assert [row for _, row in read_csv(path, {"a": number, "b": number, "text": str})] == rows


def test_writing_the_same_again_touches_no_file(store):
    scores, pins = {cell("a"): numbers()}, [pin()]
    write(store, scores, pins)
    before = {path: path.stat().st_mtime_ns for path in store.directory.rglob("*.*")}
    write(store, scores, pins)
    assert {path: path.stat().st_mtime_ns for path in store.directory.rglob("*.*")} == before
    write(store, scores, [pin(n=4)])
    changed = {path for path, then in before.items() if path.stat().st_mtime_ns != then}
    assert changed == {store.pins_path, store.directory / "checksums-sha256.txt"}


def test_rows_carry_what_is_known_of_what_they_are_of(store):
    write(store, {cell("a"): numbers(0.5), cell("a", unit=1): numbers(0.6)}, [pin()])
    (row,) = store.rows()
    assert row["unit"] == 0
    assert (row["detector"], row["mask"], row["half_fov_deg"]) == ("PD", "Slit", 30.0)
    assert (row["extractor_taxonomy"], row["model_taxonomy"]) == ("BCM", "LSQ")
    assert (row["n_test"], row["n_observable"], row["n_calibration"]) == (3, 2, None)
    assert {name: row[name] for name in METRICS} == {
        **dict.fromkeys(METRICS),
        "rms_deg": 0.5,
        "rms_all_answers_deg": 0.5,
        "availability": 1.0,
    }
    assert [one["rms_deg"] for one in store.rows(unit=None)] == [0.5, 0.6]
    assert [one["rms_deg"] for one in store.rows(unit=1)] == [0.6]


def test_queries_filter_and_name_the_nearest_field(store):
    scores = {
        cell("a"): numbers(),
        cell("b"): numbers(0.25),
        cell("b", "other"): numbers(None, status="failed"),
        cell("b", unit=1): numbers(),
    }
    write(store, scores)
    assert [r["dataset"] for r in store.query(model=["b", "z"])] == ["d", "other"]
    (row,) = store.query(model="b", status="ok", condition=None)
    assert (row["dataset"], row["rms_deg"]) == ("d", 0.25)
    frame = store.frame(model="b")
    assert list(frame["dataset"]) == ["d", "other"]
    assert frame["rms_deg"][0] == 0.25
    assert frame["rms_deg"].isna()[1]
    with pytest.raises(UnknownFieldError, match="did you mean 'dataset'"):
        store.query(datasett="d")


GOOD = "c,e,a,0,ok" + "," * len(METRICS) + ","


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (GOOD, "line 3: d/c/e/a is there twice"),
        (GOOD + ",", f"line 3: expected {6 + len(METRICS)} cells, got {7 + len(METRICS)}"),
        ("c,e,a", f"line 3: expected {6 + len(METRICS)} cells, got 3"),
        (GOOD.replace("c,e,a", "c,e,"), "line 3.*model"),
        (GOOD.replace(",0,", ",,"), r"line 3.*unit"),
        (GOOD.replace(",0,", ",one,"), "line 3.*unit"),
        (GOOD.replace("ok", "fine"), "line 3.*status"),
        (GOOD.replace("ok,", "ok,x"), "line 3.*availability"),
        (GOOD.replace("ok", '"o"k'), "line 3: not CSV"),
    ],
)
def test_a_corrupt_line_is_named_by_file_and_number(store, line, message):
    write(store, {cell("a"): numbers()})
    path = store.scores_directory / "d.csv"
    with path.open("a") as file:
        file.write(line + "\n")
    with pytest.raises(StoreError, match=message) as caught:
        store.scores()
    assert str(path) in str(caught.value)


def test_a_file_of_other_columns_or_no_text_is_named(store):
    write(store, {cell("a"): numbers()}, [pin()])
    store.pins_path.write_text("dataset,condition\n")
    with pytest.raises(StoreError, match="line 1"):
        store.pins()
    store.pins_path.write_bytes(b"\xff\xfe\xff")
    with pytest.raises(StoreError, match=r"pins\.csv.*1.*UTF-8.*0xff"):
        store.pins()
    (store.scores_directory / "d.csv").write_text("")
    with pytest.raises(StoreError, match=r"line 1.*none"):
        store.scores()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, ""),
        ({"n": 4}, "n 4, pinned 3"),
        ({"data_hash": "x"}, "data_hash x, pinned h"),
        ({"head_hash": "x"}, "head_hash x, pinned hh"),
        ({"observable": 1}, "observable 1, pinned 2"),
        ({"bound_deg": 0.25 * (1 + 5e-5)}, ""),
        ({"bound_deg": 0.25 * (1 + 2e-4)}, "bound_deg 0.25005, pinned 0.25"),
        ({"bound_deg": None}, "bound_deg None, pinned 0.25"),
        ({"head_bound_deg": 0.3}, "head_bound_deg 0.3, pinned 0.2"),
        ({"version": 2}, ""),
    ],
)
def test_pins_differ_in_hashes_exactly_and_in_bounds_beyond_rounding(changed, said):
    assert pin().difference(pin(**changed)) == said


class KeyOfGroup(BaseModel, extra="forbid"):
    key: str


TABLE: TableFile[str] = TableFile(
    "squares.csv",
    {"cell": word, "group": word, "square": number},
    KeyOfGroup,
    lambda row: str(row["cell"]),
    lambda row: str(row["group"]),
    lambda row: str(row["cell"]),
)


def rows() -> dict[str, Row]:
    return {
        cell: {"cell": cell, "group": group, "square": float(cell) ** 2, "key": f"key {group}"}
        for cell, group in (("3", "odd"), ("1", "odd"), ("2", "even"))
    }


def test_a_table_comes_back_sorted_with_what_its_groups_share(tmp_path: Path) -> None:
    assert TABLE.write(rows(), tmp_path)
    assert not TABLE.write(rows(), tmp_path)
    assert TABLE.read(tmp_path) == rows()
    assert list(TABLE.read(tmp_path)) == ["1", "2", "3"]
    (tmp_path / "squares.json").unlink()
    with pytest.raises(StoreError, match=r"line 2: 'odd' is not in squares\.json"):
        TABLE.read(tmp_path)


def test_a_cell_that_is_there_twice_is_refused_by_its_line(tmp_path: Path) -> None:
    TABLE.write(rows(), tmp_path)
    path = tmp_path / "squares.csv"
    path.write_text(path.read_text() + "2,even,5\n")
    with pytest.raises(StoreError, match=r"squares\.csv, line 5: 2 is there twice"):
        TABLE.read(tmp_path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not JSON"),
        ("[]", "Input should be a valid dictionary"),
        ('{"odd":{"clef":"x"}}', "odd/key: Field required"),
        ('{"odd":{"key":5}}', "odd/key: Input should be a valid string, got 5"),
    ],
)
def test_what_groups_share_is_refused_where_it_cannot_be_read(
    text: str, said: str, tmp_path: Path
) -> None:
    TABLE.write(rows(), tmp_path)
    (tmp_path / "squares.json").write_text(text)
    with pytest.raises(StoreError, match=rf"squares\.json\b.*{said}"):
        TABLE.read(tmp_path)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"split": "train"}, "column split: expected one of calibration, test, repeat"),
        ({"bound_deg": 0.0}, "column bound_deg: expected a number above 0, got '0'"),
        ({"bench_deg": -0.5}, "column bench_deg: expected a number of at least 0, got -0.5"),
        ({"n": None}, "expected a number in n"),
    ],
)
def test_a_pin_that_is_none_is_refused_by_its_line(
    changed: dict[str, Any], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "pins.csv"
    path.write_text(pins_text([pin(**changed)]))
    with pytest.raises(StoreError, match=f"line 2.*{said}"):
        read_pins(path)


def test_a_record_is_of_its_files_alone(tmp_path: Path) -> None:
    for name in ("a.csv", "b/c.json", "times.csv", "times_machine.json", ".d/e.csv", "f.txt"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    (tmp_path / "g.csv").mkdir()
    (tmp_path / "h.csv").symlink_to(tmp_path / "b")
    assert record_manifest.names(tmp_path) == ("a.csv", "b/c.json", "h.csv")
    assert record_manifest.changes(tmp_path) == []
    assert record_manifest.changes(tmp_path, required=True) != []


def test_nothing_is_written_to_a_record_whose_manifest_cannot_be_read(tmp_path: Path) -> None:
    assert record_manifest.write(tmp_path, {"a.csv": "x\n"}, start=True)
    assert not record_manifest.write(tmp_path, {"a.csv": "x\n"})
    (tmp_path / "checksums-sha256.txt").write_text("{")
    with pytest.raises(StoreError, match=r"checksums-sha256.txt, line 1: expected 64"):
        record_manifest.write(tmp_path, {"a.csv": "y\n"})
    assert (tmp_path / "a.csv").read_text() == "x\n"
