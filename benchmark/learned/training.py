"""Training of networks with PyTorch (extra ``learn``), which nothing else here needs.

The same layers, frames, recipe and machine give the same weights, digit for digit: one thread,
seeds from names, and no operation that adds in an order of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from types import ModuleType
from typing import Any

import numpy as np

from benchmark.learned.network import INPUT, Floats32, Layer, Network
from benchmark.seeds import generator

#: What a loss takes: the network's output and the targets of a batch, as tensors.
Loss = Callable[[Any, Any], Any]
#: Changes frames and targets of a batch at random, before they are learned from.
Augment = Callable[[np.random.Generator, Floats32, Floats32], tuple[Floats32, Floats32]]

#: Evaluates layers by their weights, as `evaluate`.
Run = Callable[[Sequence[Layer], dict[str, tuple[Any, Any]], Any], Any]


class LearnExtraMissingError(ImportError):
    """PyTorch is not installed; the message names the extra that brings it."""


@dataclass(frozen=True)
class Recipe:
    """How a network is trained: passes, frames a step, the first step's size, and the seed.

    Steps are Adam's; their size rises over the first twentieth and falls to nothing as a cosine.
    """

    epochs: int
    batch: int = 32
    rate: float = 2e-3
    seed: int = 0


def torch() -> ModuleType:
    """Return PyTorch on one thread; LearnExtraMissingError where it is missing."""
    try:
        import torch as found  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        raise LearnExtraMissingError(
            "training needs PyTorch: pip install 'sun-sensor-atlas[learn]' "
            "(networks that are trained already need none)"
        ) from error
    found.set_num_threads(1)
    found.use_deterministic_algorithms(mode=True)
    return found  # type: ignore[no-any-return, unused-ignore]  # where PyTorch is not installed


def drawn_weights(
    layers: Sequence[Layer], *names: str | int, last: float = 1.0
) -> dict[str, tuple[Any, Any]]:
    """Draw first weights as He2015 for ReLU, biases zero; as tensors that learn, by layer.

    Those of the last layer are `last` times as large.
    """
    at, stream, found = torch(), generator("learned", *names, "weights"), {}
    for layer in layers:
        if layer.shape:
            width = np.sqrt(2.0 / np.prod(layer.shape[1:])) * (last if layer is layers[-1] else 1.0)
            weight = stream.normal(scale=width, size=layer.shape).astype(np.float32)
            bias = np.zeros(layer.shape[0], dtype=np.float32)
            found[layer.name] = tuple(
                at.from_numpy(part).requires_grad_(requires_grad=True) for part in (weight, bias)
            )
    return found


def evaluate(layers: Sequence[Layer], weights: dict[str, tuple[Any, Any]], frames: Any) -> Any:
    """Evaluate layers as `Network` does, on tensors whose gradients are known."""
    functions = torch().nn.functional
    outputs = {INPUT: frames}
    for layer in layers:
        of = [outputs[name] for name in layer.inputs]
        match layer.operation:
            case "convolution":
                found = functions.conv2d(of[0], *weights[layer.name], padding=layer.shape[2] // 2)
            case "dense":
                found = functions.linear(of[0].flatten(1), *weights[layer.name])
            case "relu":
                found = of[0].relu()
            case "maximum":
                found = functions.max_pool2d(of[0], 2)
            case "mean":
                found = functions.avg_pool2d(of[0], 2)
            case "double":
                # of `repeat_interleave` and `interpolate` gradients are slow or of no fixed order
                count, channels, rows, columns = of[0].shape
                wide = of[0][:, :, :, None, :, None].expand(-1, -1, -1, 2, -1, 2)
                found = wide.reshape(count, channels, 2 * rows, 2 * columns)
            case _:
                found = torch().cat(of, dim=1)
        outputs[layer.name] = found
    return outputs[layers[-1].name]


def train(
    name: str,
    layers: Sequence[Layer],
    frames: Floats32,
    targets: Floats32,
    *,
    loss: Loss,
    recipe: Recipe,
    card: dict[str, Any],
    augment: Augment | None = None,
    run: Run | None = None,
    last: float = 1.0,
) -> Network:
    """Train a network.

    Parameters
    ----------
    name
        Of the network; with the recipe's seed it names all random streams.
    layers
        Of the network.
    frames
        (N, C, H, W), float32.
    targets
        (N, ...), float32, as the loss takes them.
    loss
        Mean over a batch, of tensors.
    recipe
        Passes, batches, steps.
    card
        What the frames are of; recipe, last loss and framework are added.
    augment
        Changes a batch before it is learned from, or None.
    run, last
        Evaluates layers with weights that are shared otherwise than `evaluate` does, or None;
        size of the last layer's first weights over the others'.

    Returns
    -------
    Network
        With the weights after the last step.

    Raises
    ------
    LearnExtraMissingError
        Without PyTorch.
    """
    at = torch()
    weights = drawn_weights(layers, name, recipe.seed, last=last)
    moving = at.optim.Adam([part for pair in weights.values() for part in pair], lr=recipe.rate)
    steps = recipe.epochs * -(-len(frames) // recipe.batch)
    done, ended = 0, 0.0
    for epoch in range(recipe.epochs):
        stream = generator("learned", name, recipe.seed, "epoch", epoch)
        order, losses = stream.permutation(len(frames)), []
        for start in range(0, len(order), recipe.batch):
            rows = order[start : start + recipe.batch]
            given, wanted = frames[rows], targets[rows]
            if augment is not None:
                given, wanted = augment(stream, given, wanted)
            moving.param_groups[0]["lr"] = recipe.rate * _share(done / steps)
            found = (run or evaluate)(layers, weights, at.from_numpy(given))
            value = loss(found, at.from_numpy(wanted))
            moving.zero_grad()
            value.backward()
            moving.step()
            losses.append(float(value.detach()))
            done += 1
        ended = float(np.mean(losses))
    said = {
        **card,
        "name": name,
        "recipe": asdict(recipe),
        "frames": len(frames),
        "last_loss": float(f"{ended:.6g}"),
        "framework": f"torch {at.__version__}",
    }
    kept = {
        key: (pair[0].detach().numpy().copy(), pair[1].detach().numpy().copy())
        for key, pair in weights.items()
    }
    return Network(tuple(layers), kept, said)


def _share(done: float) -> float:
    """Return the size of a step over the recipe's: a ramp, then half a cosine."""
    return float(min(done / 0.05, 1.0) * 0.5 * (1.0 + np.cos(np.pi * done)))
