"""Parameters as plain JSON: exact numbers, types named, nothing that JSON has no word for."""

from __future__ import annotations

import json
from dataclasses import dataclass, field

import numpy as np
import pytest

from algorithms.contract import Observation, SensorGeometry
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


def test_a_design_tells_its_first_fields_always_and_later_ones_where_there_are_any() -> None:
    described = describe(SensorGeometry(line_axes=("x",)))
    assert described.pop("type") == "SensorGeometry"
    assert described.pop("line_axes") == ["x"]
    assert set(described) == {
        "focal_length_mm", "pixel_pitch_mm", "centre_px", "aperture_width_mm", "aperture_shape",
        "face_normals", "half_fov_deg",
    }  # fmt: skip
    assert set(described.values()) == {None}


def test_numpy_s_numbers_and_words_of_an_enumeration_are_plain() -> None:
    found = describe((np.float64(0.5), np.int64(2), Observation.FRAMES, True))
    assert found == [0.5, 2, str(Observation.FRAMES), True]
    assert [type(one) for one in found] == [float, int, str, bool]
    assert json.loads(json.dumps(found)) == found


@pytest.mark.parametrize("value", [float("nan"), float("inf"), np.float64("-inf")])
def test_a_number_that_json_has_no_word_for_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"parameters must be finite; got (nan|inf|-inf)"):
        describe(Part(size=value))
