"""JSON is read to the letter, and what is refused is named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from files.reading import FileRefusedError
from files.strict_json import DEEPEST, parse_json, require_members, require_type

PATH = Path("given.json")

values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=12,
)  # fmt: skip


@given(values)
def test_what_json_writes_is_read_as_it_was(value: Any) -> None:
    assert parse_json(json.dumps(value), PATH) == value


@pytest.mark.parametrize(
    ("text", "said", "line"),
    [
        ('{"a": 1,\n "a": 2}', "'a' stands twice", None),
        ('{"a": NaN}', "NaN is no number", None),
        ("[-Infinity]", "-Infinity is no number", None),
        ("[1e999]", "1e999 is out of range", None),
        ('{"a": 1,\n}', "not JSON", 2),
        ("", "not JSON", 1),
        ("[" * (DEEPEST + 1) + "]" * (DEEPEST + 1), f"deeper than {DEEPEST}", None),
        ("[" * 100_000 + "]" * 100_000, f"deeper than {DEEPEST}", None),
    ],
)
def test_what_is_no_plain_json_is_refused_with_the_reason(
    text: str, said: str, line: int | None
) -> None:
    with pytest.raises(FileRefusedError, match=r"given\.json") as caught:
        parse_json(text, PATH)
    assert said in caught.value.reason
    assert caught.value.line == line


def test_the_deepest_document_that_is_taken_is_as_deep_as_said() -> None:
    assert parse_json("[" * (DEEPEST - 1) + "]" * (DEEPEST - 1), PATH)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([1], "expected an object, got an array"),
        ({"count": 1}, "'name' is missing"),
        ({"name": "x", "count": True}, "count: expected a whole number, got a truth value True"),
        ({"name": None, "count": 1}, "name: expected text, got null"),
        ({"name": "x", "count": 1, "more": 2}, "unknown member 'more'; expected name, count"),
    ],
)
def test_a_member_that_is_missing_unknown_or_of_another_type_is_named(
    value: Any, said: str
) -> None:
    with pytest.raises(FileRefusedError) as caught:
        require_members(value, PATH, {"name": str, "count": int})
    assert said in caught.value.reason


def test_one_of_several_types_will_do() -> None:
    assert require_type(1, (int, float), PATH, "size") == 1
    assert require_members({"on": False}, PATH, {"on": bool}) == {"on": False}
    with pytest.raises(FileRefusedError, match="a whole number or a number, got text") as caught:
        require_type("1", (int, float), PATH, "size", 7)
    assert caught.value.line == 7
