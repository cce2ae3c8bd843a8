"""Networks without a framework: each layer against SciPy or a sum by hand, and broken files."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import correlate2d

from benchmark.learned.network import (
    INPUT,
    Layer,
    Network,
    NetworkFileError,
    chained,
    convolutions,
)
from benchmark.learned.training import LearnExtraMissingError, torch

DRAWN = np.random.default_rng(5)


def drawn(*shape: int) -> np.ndarray:
    return DRAWN.normal(size=shape).astype(np.float32)


def alone(operation: str, *shape: int) -> Network:
    layer = Layer("one", operation, (INPUT,), shape)
    return Network((layer,), {"one": (drawn(*shape), drawn(shape[0]))} if shape else {}, {})


@pytest.mark.parametrize("size", [1, 3, 5])
def test_a_convolution_is_the_sum_of_correlations_of_its_channels(size) -> None:
    frames, network = drawn(2, 3, 8, 7), alone("convolution", 4, 3, size, size)
    weight, bias = network.weights["one"]
    found = network(frames)
    for n, out in np.ndindex(2, 4):
        expected = bias[out] + sum(
            correlate2d(frames[n, c], weight[out, c], mode="same") for c in range(3)
        )
        np.testing.assert_allclose(found[n, out], expected, atol=1e-5)


def test_a_dense_layer_takes_all_values_of_a_frame() -> None:
    frames, network = drawn(3, 2, 4, 5), alone("dense", 6, 40)
    weight, bias = network.weights["one"]
    expected = np.einsum("ok,nk->no", weight, frames.reshape(3, 40)) + bias
    np.testing.assert_allclose(network(frames), expected, atol=1e-5)


def test_pools_rectifier_and_doubling_on_numbers_worked_by_hand() -> None:
    frame = np.array([[[[1, 2, -5], [3, 6, 9]]]], dtype=np.float32)
    assert alone("maximum")(frame).tolist() == [[[[6]]]]
    assert alone("mean")(frame).tolist() == [[[[3]]]]
    assert alone("relu")(frame).tolist() == [[[[1, 2, 0], [3, 6, 9]]]]
    assert (
        alone("double")(frame)[0, 0].tolist()
        == [[1, 1, 2, 2, -5, -5]] * 2 + [[3, 3, 6, 6, 9, 9]] * 2
    )


def branched() -> Network:
    layers = (
        *convolutions("down", (1, 2, 2), INPUT),
        Layer("pooled", "maximum", ("down1.relu",)),
        Layer("up", "double", ("pooled",)),
        Layer("both", "concatenate", ("up", "down1.relu")),
        *chained(("out", "convolution", (1, 4, 1, 1)), of="both"),
    )
    weights = {one.name: (drawn(*one.shape), drawn(one.shape[0])) for one in layers if one.shape}
    return Network(layers, weights, {"trained_on": "nothing", "seed": 3})


def test_frames_are_evaluated_one_by_one_whatever_is_beside_them() -> None:
    network, frames = branched(), drawn(40, 8, 8)
    together = network(frames)
    np.testing.assert_array_equal(together[33:35], network(frames[33:35]))
    assert network.parameters == 20 + 38 + 5


def test_a_saved_network_comes_back_with_its_card_and_its_numbers(tmp_path: Path) -> None:
    network, frames = branched(), drawn(2, 8, 8)
    paths = [tmp_path / name for name in ("a.npz", "b.npz")]
    for path in paths:
        network.save(path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    again = Network.load(paths[0])
    assert dict(again.card) == {"trained_on": "nothing", "seed": 3}
    np.testing.assert_array_equal(again(frames), network(frames))


def test_broken_files_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(NetworkFileError, match=r"none\.npz: there is no such network"):
        Network.load(tmp_path / "none.npz")
    path = tmp_path / "broken.npz"
    path.write_bytes(b"PK no archive")
    with pytest.raises(NetworkFileError, match=r"broken\.npz"):
        Network.load(path)
    branched().save(path)
    with np.load(path) as held:
        arrays = {name: held[name] for name in held.files}
    faults = {
        "has no 'out.bias'": {name: part for name, part in arrays.items() if name != "out.bias"},
        "has no 'card'": {name: part for name, part in arrays.items() if name != "card"},
        "arrays of no layer: more": {**arrays, "more": arrays["out.bias"]},
        "not finite": {**arrays, "out.bias": np.full(1, np.nan, dtype=np.float32)},
        "expected float32 weights": {**arrays, "out.bias": np.zeros(1)},
    }
    for said, held in faults.items():
        np.savez(path, **held)
        with pytest.raises(NetworkFileError, match=said):
            Network.load(path)


@pytest.mark.parametrize(
    ("operation", "inputs", "shape", "said"),
    [
        ("softplus", (INPUT,), (), "no operation 'softplus'"),
        ("convolution", (INPUT,), (1, 1, 2, 2), "odd and square"),
        ("dense", (INPUT,), (), "weights of dense are not"),
        ("relu", ("later",), (), "no layer 'later' before it"),
    ],
)
def test_layers_that_cannot_be_are_refused(operation, inputs, shape, said) -> None:
    with pytest.raises(ValueError, match=said):
        Network((Layer("one", operation, inputs, shape),), {}, {})


def test_frames_of_other_channels_are_refused() -> None:
    with pytest.raises(ValueError, match="layer one takes 3; got 1"):
        alone("convolution", 1, 3, 3, 3)(drawn(2, 4, 4))
    with pytest.raises(ValueError, match="frames must be"):
        alone("relu")(drawn(4, 4))


def test_training_without_the_framework_names_the_extra(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(LearnExtraMissingError, match=r"sun-sensor-atlas\[learn\]"):
        torch()
