"""Texts of cells as numbers: moments, angles in minutes and seconds."""

from __future__ import annotations

import datetime as dt

import pandas as pd
import pytest

from calibrate.forms.cells import numbers_of

MOMENT = dt.datetime(2024, 3, 5, 6, 7, 8, 250_000, tzinfo=dt.UTC)


@pytest.mark.parametrize(
    "cell", ["2024-03-05T06:07:08.250Z", "2024-03-05 06:07:08.25", "2024-03-05T07:07:08.250+01:00"]
)
def test_a_date_is_seconds_since_1970_with_their_fraction(cell: str) -> None:
    found = numbers_of(pd.Series([cell, "2024-03-05T06:07:09Z"]), ".", of_time=True)
    seconds = [MOMENT.timestamp(), MOMENT.timestamp() + 0.75]
    assert found.values.tolist() == pytest.approx(seconds, abs=1e-6)


def test_minutes_and_seconds_are_sixtieths_and_carry_the_sign() -> None:
    found = numbers_of(pd.Series(["-12:30:36", "0:00:36"]), ".", of_time=False)
    assert found.values.tolist() == pytest.approx([-12.51, 0.01])
    found = numbers_of(pd.Series(["01:02:03.5"]), ".", of_time=True)
    assert found.values.tolist() == pytest.approx([3723.5])
