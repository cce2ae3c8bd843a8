"""Fixed columns of tables: what is written is what the list says, whatever the rows hold."""

import csv
import io
import itertools
from typing import Annotated, Any, Literal

from pydantic import Field

from api.schema.base import Shape
from api.schema.claims import ClaimRow
from api.schema.scores import LeaderboardRow, Score
from api.schema.studies import AttributeValue
from api.schema.table import AS_TEXT, Column, ColumnEach, columns_of, csv_of, described_columns
from api.schema.vocabulary import MEANINGS
from benchmark.metrics.rings import EDGES_DEG


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


def test_members_become_columns_by_what_they_hold():
    class Inner(Shape):
        size: float | None = Field(description="A size.")

    class Many(Shape):
        many: list[Inner]

    class Outer(Many):
        """Members of a class stand behind those of the class it extends."""

        name: str
        inner: Inner | None
        words: list[str] = Field(description="Words.")
        bounds: dict[str, float]
        anything: dict[str, Any]
        kind: Literal["a", "b"]
        values: Annotated[dict[str, list[str]], ColumnEach(("detector", "mask"))]
        notes: Annotated[list[Inner], AS_TEXT]

    found = described_columns(Outer)
    assert list(found) == [
        *("name", "inner_size", "words", "bounds", "kind", "detector", "mask", "notes")
    ]
    assert found["inner_size"] == Column("inner_size", "number", "A size.", single=True)
    assert found["words"] == Column(
        "words", "string", "Words, separated by semicolons.", single=False
    )
    assert [name for name, column in found.items() if column.single] == [
        *("name", "inner_size", "kind")
    ]
    assert found["name"].description == MEANINGS["name"]


def test_published_headers_stay_as_they_are():
    """Programs read them by name and by place."""
    heads = {
        AttributeValue: "attribute,value,basis,source,source_name,note,role,name_in_study,nearest",
        Score: "dataset,condition,extractor,model,status,reason,rms_deg,charged_deg,aligned_deg,"
        "bound_deg,bound_unit_deg,availability,false_sun",
        LeaderboardRow: "rank,group,tied,dataset,condition,extractor,model,status,"
        "reason,rms_deg,charged_deg",
        ClaimRow: "id,section,section_name,study,statement,verdict,trials,explanation",
    }
    for model, head in heads.items():
        assert ",".join(columns_of(model)).startswith(head)


def test_rings_of_the_tables_are_those_that_are_measured():
    edges = itertools.pairwise(EDGES_DEG)
    rings = {f"rms_{inner:g}_{outer:g}_deg" for inner, outer in edges}
    for table in (columns_of(Score), columns_of(LeaderboardRow)):
        assert rings == {name for name in table if name.count("_") == 3 and name[4].isdigit()}
