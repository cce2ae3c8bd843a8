"""Processors and by what they are slower than the machine of the published times."""

from __future__ import annotations

import pytest

from survey_data.processors import UnknownProcessorError, factor, processors


def test_processors_stand_in_the_order_of_their_published_speed() -> None:
    """Rad-hard LEON3FT, RAD750, microcontrollers, Zynq, Raspberry Pi: a class apart each."""
    order = ["raspberry-pi-4", "zynq-7000", "cortex-m7", "cortex-m4", "rad750", "gr712rc"]
    found = [factor(name) for name in order]
    assert found == sorted(found)
    assert 2.0 <= found[0] <= 4.0
    assert 80.0 <= found[-1] <= 160.0
    assert {*order, "reference"} == set(processors())


def test_a_factor_has_at_most_two_digits_and_its_origin_is_named() -> None:
    for one in processors().values():
        assert one.factor == float(f"{one.factor:.2g}")
        assert one.basis
        assert one.source


@pytest.mark.parametrize(("given", "found"), [(3, 3.0), ("2.5", 2.5), (" Zynq-7000 ", 11.0)])
def test_a_number_is_taken_as_it_is_and_a_name_whatever_its_case(
    given: str | float, found: float
) -> None:
    assert factor(given) == found


@pytest.mark.parametrize("given", [0, -1.0, float("nan"), float("inf"), "0", "", "-3"])
def test_a_number_that_is_no_factor_is_refused(given: str | float) -> None:
    with pytest.raises(UnknownProcessorError, match="a number above 0"):
        factor(given)


def test_an_unknown_name_lists_the_known_ones_and_the_nearest() -> None:
    with pytest.raises(UnknownProcessorError, match=r"rad750.*did you mean 'zynq-7000'"):
        factor("zynq")
