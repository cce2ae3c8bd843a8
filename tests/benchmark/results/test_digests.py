"""What changes a digest, and what does not."""

from dataclasses import dataclass, replace
from enum import Enum
from types import SimpleNamespace

import fake_atlas
import numpy as np
import pytest

from benchmark.canonical import canonical_json, digest
from benchmark.datasets import corrected
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.results.digests import condition_digests


class Colour(Enum):
    RED = "red"


@dataclass(frozen=True)
class Inner:
    b: tuple[float, ...] = (1.0,)


def test_canonical_json_has_one_spelling():
    value = {"b": Inner((0.1 + 0.2, np.float32(2.0))), "a": {3, 1}, "c": Colour.RED, "d": None}
    assert canonical_json(value) == '{"a":[1,3],"b":{"b":[0.3,2.0]},"c":"red","d":null}'
    assert digest(value) == digest(dict(reversed(value.items())))


def test_arrays_enter_with_their_type_and_non_finite_numbers_by_name():
    assert digest(np.array([1, 2])) != digest(np.array([1.0, 2.0]))
    assert canonical_json([float("inf"), float("nan")]) == '["inf","nan"]'


def test_the_data_hash_sees_every_array_its_shape_and_type_but_not_its_memory_layout():
    sun = np.eye(3)
    frames = np.arange(24, dtype=np.uint16).reshape(3, 2, 4)

    def hashed(observations, sun=sun, origin=None):
        return samples_hash(SimpleNamespace(observations=observations, sun=sun, origin_px=origin))

    base = hashed(frames)
    assert len(base) == 32
    assert hashed(np.asfortranarray(frames)) == base
    assert hashed(frames.astype(">u2")) == base
    others = [
        hashed(frames.reshape(3, 4, 2)),
        hashed(frames.astype(np.int16)),
        hashed(frames, -sun),
        hashed(frames, origin=np.zeros((3, 2))),
        hashed(frames, origin=np.ones((3, 2))),
        hashed(frames + np.uint16(1)),
    ]
    assert len({base, *others}) == 7


def samples(count=6, **changed):
    rng = np.random.default_rng(3)
    arrays = {
        "observations": rng.integers(0, 99, (count, 4)),
        "sun": rng.random((count, 3)),
        "origin_px": rng.random((count, 2)),
        "context": {"albedo": rng.random(count)},
    }
    return SimpleNamespace(**{**arrays, **changed})


def test_the_hash_of_the_head_is_that_of_the_first_samples_alone():
    whole = samples()
    cut = {name: getattr(whole, name)[:HEAD] for name in ("observations", "sun", "origin_px")}
    head = SimpleNamespace(**cut, context={"albedo": whole.context["albedo"][:HEAD]})
    assert head_hash(whole) == samples_hash(head) == head_hash(head)
    assert head_hash(whole) != samples_hash(whole)


@pytest.mark.parametrize("name", ["observations", "sun", "origin_px", "context"])
@pytest.mark.parametrize(("place", "in_head"), [(0, True), (HEAD - 1, True), (HEAD, False)])
def test_the_head_sees_its_own_samples_and_the_whole_sees_all(name, place, in_head):
    whole, other = samples(), samples()
    array = other.context["albedo"] if name == "context" else getattr(other, name)
    array[place] += 1
    assert samples_hash(other) != samples_hash(whole)
    assert (head_hash(other) != head_hash(whole)) is in_head


def data_digest(preset) -> str:
    """Of its first condition."""
    return next(iter(condition_digests(preset).values()))


def test_a_condition_s_digest_depends_on_its_own_parameters_and_those_of_its_references(
    monkeypatch,
):
    """Readings are corrected by those of the first condition whose detector is theirs."""
    before = condition_digests(fake_atlas.Diodes())
    assert list(before) == list(fake_atlas.Diodes().conditions) == ["quiet", "noisy"]
    monkeypatch.setattr(corrected, "reference_condition", lambda *_: "quiet")
    before = condition_digests(fake_atlas.Diodes())
    parameters = fake_atlas.Diodes.parameters
    for changed, expected in (("noisy", ["noisy"]), ("quiet", ["quiet", "noisy"])):

        def moved(self, condition, changed=changed):
            more = {"more": 1} if condition == changed else {}
            return {**parameters(self, condition), **more}

        with monkeypatch.context() as patch:
            patch.setattr(fake_atlas.Diodes, "parameters", moved)
            after = condition_digests(fake_atlas.Diodes())
        assert [name for name in before if after[name] != before[name]] == expected


def test_a_data_set_s_digest_depends_on_version_parameters_conditions_and_name():
    preset = fake_atlas.Diodes()
    others = [
        replace(preset, version=2),
        replace(preset, seed=8),
        replace(preset, name="fake-other"),
    ]
    found = {data_digest(one) for one in (preset, *others)}
    assert len(found) == 1 + len(others)
    assert data_digest(fake_atlas.Diodes()) == data_digest(preset)
    fewer = condition_digests(replace(preset, conditions=("quiet",)))
    assert fewer == {"quiet": data_digest(preset)}
    assert {len(one) for one in found} == {16}
