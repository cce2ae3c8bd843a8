"""One spelling of what stands in a cell, for the command line, the service and the deposit."""

import math
from enum import Enum, IntEnum, StrEnum

import pytest

from api.cells import cell, plain_value


class Word(StrEnum):
    """A choice that is text."""

    NEAR = "near"


class Number(IntEnum):
    """A choice that is a number."""

    TWO = 2


class Other(Enum):
    """A choice that is neither."""

    FAR = "far"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, ""),
        (math.nan, ""),
        (True, "true"),
        (0, "0"),
        (0.1 + 0.2, "0.30000000000000004"),
        (1e-7, "1e-07"),
        ("é, “quoted”", "é, “quoted”"),
        (("b", "a", None), "b; a; "),
        ({"b", "a"}, "a; b"),
        ({"é": math.nan, "k": [1]}, '{"é": null, "k": [1]}'),
        (Word.NEAR, "near"),
        ([Word.NEAR, Number.TWO], "near; 2"),
        ({"k": Number.TWO, "w": Word.NEAR}, '{"k": 2, "w": "near"}'),
    ],
)
def test_a_cell_is_spelled_one_way(value, text):
    assert cell(value) == text


@pytest.mark.parametrize("value", [1j, Other.FAR])
def test_what_no_document_holds_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match=type(value).__name__):
        plain_value([value])
