"""A tumbling body under the pole, and tables of light that are let go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark.simulator.flight.attitude import Tumble
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.light.memory import LightMemory


def test_a_momentum_has_no_direction_from_a_sun_over_the_pole() -> None:
    tumble = Tumble(60.0, 10.0, 1.0, 0.5)
    orbit: Any = CircularOrbit
    with pytest.raises(ValueError, match="must not stand over Earth's pole"):
        tumble.matrices(orbit, np.array([0.0, 0.0, 1.0]), np.zeros(1))


def test_only_tables_that_a_shared_directory_holds_are_let_go(tmp_path: Path) -> None:
    memory, made = LightMemory(), []

    @memory.tables(2, mapped=True)
    def squares(last: int) -> int:
        made.append(last)
        return last**2

    squares(3)
    memory.release_mapped()
    squares(3)
    assert made == [3], "nobody else has it"
    memory.share_tables(tmp_path)
    memory.release_mapped()
    assert squares(3) == 9
    assert made == [3, 3]
