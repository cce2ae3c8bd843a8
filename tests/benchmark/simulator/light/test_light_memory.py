"""Light that is kept is the rendered light, and keeping it changes no number."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from benchmark.datasets import get
from benchmark.datasets.samples import samples_hash
from benchmark.simulator.light.memory import LightMemory, memory


@pytest.fixture
def forgetful():
    memory.forget()
    yield memory
    memory.forget()


def light(seed, lit=0.2):
    generator = np.random.default_rng(seed)
    array = generator.random((4, 6, 5))
    array[generator.random(array.shape) > lit] = 0.0
    return array


@pytest.mark.parametrize("lit", [0.0, 0.2, 1.0])
def test_kept_light_comes_back_to_the_last_bit_as_the_callers_own(lit):
    kept = LightMemory()
    kept.cache_for("dataset")
    for _ in range(3):
        given = kept.render("key", lambda: light(1, lit))
        np.testing.assert_array_equal(given, light(1, lit))
        given += 1.0  # what a caller does to it stays its own affair
    assert kept.hits == 2
    assert kept.kept_bytes <= 12 * np.count_nonzero(light(1, lit)), "dark elements take no room"


def test_nothing_is_kept_unasked_or_for_another_owner_or_beyond_the_limit():
    kept = LightMemory(limit_bytes=4 * 6 * 5 * 8)
    calls = []

    def render(key):
        return kept.render(key, lambda: calls.append(key) or light(key, 1.0))

    render(1), render(1)
    assert calls == [1, 1]
    kept.cache_for("one")
    render(1), render(1)
    assert calls == [1, 1, 1]
    render(2), render(2), render(1)  # the first stays, the second found no room
    assert calls == [1, 1, 1, 2, 2]
    assert kept.kept_bytes == kept.limit_bytes
    kept.cache_for("another")
    assert kept.kept_bytes == 0
    render(1)
    assert calls[-1] == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "cmos-single-aperture",
        "cmos-single-aperture-pinhole",
        "ccd-orbit",
        "ccd-slit",
        "cmos-multi-aperture",
        "cmos-lens",
        "event-l-slit",
    ],
)
def test_conditions_that_share_light_give_what_each_gives_alone(name, forgetful):
    preset = get(name)
    conditions = preset.conditions[:4]

    def everything():
        for condition in conditions:
            bound = preset.bound(condition, "test", 3)
            yield samples_hash(preset.generate(condition, "test", 3)), bound.angle_deg.tolist()

    alone = list(everything())
    forgetful.cache_for(name)
    shared = list(everything())
    assert shared == alone
    assert forgetful.hits > 0


@dataclasses.dataclass(frozen=True)
class Named:
    size: float


def test_tables_are_made_once_for_all_that_share_a_directory(tmp_path):
    made = []

    def make():
        made.append(1)
        return np.random.default_rng(0).normal(size=(3, 5))

    one, other, alone = LightMemory(), LightMemory(), LightMemory()
    one.share_tables(tmp_path)
    other.share_tables(tmp_path)
    first, second = one.mapped(Named(0.1), make), other.mapped(Named(0.1), make)
    assert len(made) == 1
    assert first.tobytes() == second.tobytes()
    assert not second.flags.writeable
    other.mapped(Named(np.nextafter(0.1, 1.0).item()), make)
    assert len(made) == 2, "another by its last bit"
    alone.mapped(Named(0.1), make)
    assert len(made) == 3
    assert len(list(tmp_path.iterdir())) == 2
