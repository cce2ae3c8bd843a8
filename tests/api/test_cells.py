"""One spelling of what stands in a cell, for the command line, the service and the deposit."""

import math

import pytest

from api.cells import cell, plain_value


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, ""),
        (math.nan, ""),
        (math.inf, ""),
        (True, "true"),
        (False, "false"),
        (0, "0"),
        (1.0, "1.0"),
        (0.1 + 0.2, "0.30000000000000004"),
        (1e-7, "1e-07"),
        ("é, “quoted”", "é, “quoted”"),
        (("b", "a", None), "b; a; "),
        ({"b", "a"}, "a; b"),
        ([0.5, True], "0.5; true"),
        ({"é": math.nan, "k": [1]}, '{"é": null, "k": [1]}'),
    ],
)
def test_a_cell_is_spelled_one_way(value, text):
    assert cell(value) == text


def test_what_no_document_holds_is_refused():
    with pytest.raises(TypeError, match="complex"):
        plain_value([1j])
