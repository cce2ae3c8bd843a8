"""Models: what a member means, and the columns that its type implies."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from api.schema.base import Described, Shape
from api.schema.table import columns_of, csv_of, described_columns, sortable
from api.schema.vocabulary import MEANINGS


class Rows(Described):
    """A model with members that the vocabulary knows, that say it themselves, and that nobody does.

    The last has a member whose description was forgotten.
    """

    detector: str
    count: int = Field(description="Number of moons.")
    rms_0_10_deg: float
    forgotten: str


def test_a_member_is_described_by_itself_or_by_the_vocabulary_or_not_at_all() -> None:
    members = Rows.model_json_schema()["properties"]
    said = {name: member.get("description") for name, member in members.items()}
    assert said == {
        "detector": MEANINGS["detector"],
        "count": "Number of moons.",
        "rms_0_10_deg": "RMS error 0 to 10 degrees off the axis.",
        "forgotten": None,
    }


class Part(BaseModel):
    """A nested model."""

    name: str
    share: Annotated[float, Field(ge=0)] | None


class Table(Shape):
    """Types with annotations inside other types."""

    key: Annotated[str, Field(min_length=1)]
    limits: list[Annotated[int, Field(ge=0)]]
    words: dict[str, Annotated[str, Field(min_length=1)]]
    kind: Annotated[Literal["a", "b"], "a remark"] | None
    part: Annotated[Part, "a remark"] | None
    parts: list[Annotated[Part, "a remark"]]
    either: str | int


def test_annotations_inside_a_type_change_no_column() -> None:
    """Lists of models and types of several kinds are in JSON alone."""
    found = described_columns(Table)
    assert {name: (column.type, column.single) for name, column in found.items()} == {
        "key": ("string", True),
        "limits": ("string", False),
        "words": ("string", False),
        "kind": ("string", True),
        "part_name": ("string", True),
        "part_share": ("number", True),
    }
    assert sortable(Table) == ("key", "kind", "part_name", "part_share")


def test_rows_of_such_a_model_are_written_in_its_columns() -> None:
    row = {"key": "x", "limits": [1, 2], "part": {"name": "y", "share": 0.5}, "parts": [], "z": 1}
    assert csv_of(columns_of(Table), [row]) == (
        "key,limits,words,kind,part_name,part_share\nx,1; 2,,,y,0.5\n"
    )
