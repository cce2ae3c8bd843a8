"""Training, where its framework is installed: the same layers as without it, the same digits."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.learned.network import INPUT, Layer, Network, chained, convolutions
from benchmark.learned.training import Recipe, drawn_weights, evaluate, train

torch = pytest.importorskip("torch")

LAYERS = (
    *convolutions("down", (1, 2, 3), INPUT),
    Layer("pooled", "maximum", ("down1.relu",)),
    Layer("means", "mean", ("down1.relu",)),
    Layer("both", "concatenate", ("pooled", "means")),
    Layer("up", "double", ("both",)),
    *chained(("out", "convolution", (2, 6, 1, 1)), ("ends", "dense", (2, 128)), of="up"),
)
FRAMES = np.random.default_rng(1).normal(size=(24, 1, 8, 8)).astype(np.float32)


def test_tensors_and_arrays_go_through_the_same_layers() -> None:
    weights = drawn_weights(LAYERS, "a test")
    kept = {name: tuple(part.detach().numpy() for part in two) for name, two in weights.items()}
    expected = evaluate(LAYERS, weights, torch.from_numpy(FRAMES)).detach().numpy()
    np.testing.assert_allclose(Network(LAYERS, kept, {})(FRAMES), expected, atol=1e-5)


def trained(epochs: int, seed: int = 0) -> Network:
    targets = FRAMES.mean(axis=(2, 3)) @ np.ones((1, 2), dtype=np.float32)
    recipe = Recipe(epochs=epochs, batch=8, seed=seed)
    loss = torch.nn.functional.mse_loss
    return train("a test", LAYERS, FRAMES, targets, loss=loss, recipe=recipe, card={})


def test_training_again_gives_the_same_digits_and_another_seed_others() -> None:
    one, again, other = trained(2), trained(2), trained(2, seed=1)
    np.testing.assert_array_equal(one(FRAMES), again(FRAMES))
    assert not np.array_equal(one(FRAMES), other(FRAMES))


def test_more_passes_leave_a_smaller_loss() -> None:
    assert trained(60).card["last_loss"] < 0.1 * trained(1).card["last_loss"]
