"""Fixed columns of tables: what is written is what the list says, whatever the rows hold."""

import csv
import io
import itertools

import pytest

from api import columns
from api.columns import csv_of
from benchmark.metrics.rings import EDGES_DEG

TABLES = {
    name: value
    for name, value in vars(columns).items()
    if name.isupper() and not name.startswith("_") and isinstance(value, tuple)
}


def test_csv_survives_its_own_delimiters_and_leaves_out_what_is_no_column():
    rows = [
        {"a": 'x, "y"\nz', "b": {"c": 1.5, "d": None}, "e": ["p", "q"], "f": True, "g": 1},
        {"a": "", "b": {"c": float("nan")}, "e": [], "f": False},
    ]
    text = csv_of(("f", "a", "b_c", "b_d", "e"), rows)
    assert list(csv.DictReader(io.StringIO(text, newline=""))) == [
        {"f": "true", "a": 'x, "y"\nz', "b_c": "1.5", "b_d": "", "e": "p; q"},
        {"f": "false", "a": "", "b_c": "", "b_d": "", "e": ""},
    ]


def test_a_mapping_that_is_a_column_is_json_in_its_cell():
    text = csv_of(("n", "by"), [{"n": 1, "by": {"nominal": 0.5, "hot": None}}])
    assert text == 'n,by\n1,"{""nominal"": 0.5, ""hot"": null}"\n'


def test_an_empty_table_has_its_header():
    assert csv_of(("a", "b"), []) == "a,b\n"


@pytest.mark.parametrize("name", TABLES)
def test_no_table_has_a_column_twice(name):
    assert len(set(TABLES[name])) == len(TABLES[name]) > 1


def test_rings_of_the_tables_are_those_that_are_measured():
    edges = itertools.pairwise(EDGES_DEG)
    rings = {f"rms_{inner:g}_{outer:g}_deg" for inner, outer in edges}
    for table in (columns.RESULTS, columns.LEADERBOARD):
        assert rings == {name for name in table if name.count("_") == 3 and name[4].isdigit()}
