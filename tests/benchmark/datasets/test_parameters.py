"""Parameters as plain JSON: exact numbers, types named, nothing that JSON has no word for."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from benchmark.canonical import canonical_json
from benchmark.datasets.parameters import describe


@dataclass(frozen=True)
class Part:
    size: float = 0.1 + 0.2
    names: tuple[str, ...] = ("a",)
    derived: int = field(init=False, default=7)


def test_a_dataclass_names_its_type_and_tells_every_field() -> None:
    assert describe(Part()) == {"type": "Part", "size": 0.1 + 0.2, "names": ["a"], "derived": 7}
    assert describe({"part": Part(), 3: None}) == {"part": describe(Part()), "3": None}


def test_parameters_are_exact_where_digests_forgive_the_last_bits() -> None:
    nearly = Part(size=0.3)
    assert describe(Part()) != describe(nearly)
    assert canonical_json(Part()) == canonical_json(nearly) == '{"names":["a"],"size":0.3}'


@pytest.mark.parametrize("value", [float("nan"), float("inf"), np.float64("-inf")])
def test_a_number_that_json_has_no_word_for_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"parameters must be finite; got (nan|inf|-inf)"):
        describe(Part(size=value))
