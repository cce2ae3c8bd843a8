"""A small network as one file: its layers, its weights, and what it was trained on.

The file is an NPZ: ``card`` is JSON as bytes, with the layers under ``layers``; beside it stand
``NAME.weight`` and ``NAME.bias`` in float32 of each layer that has weights. Layers are evaluated by
NumPy alone, so that no framework is needed where a network is used.
"""

from __future__ import annotations

import json
import math
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from files.atomic import replace_file

Floats32 = NDArray[np.float32]

#: Name of what a network is given, as layers name it.
INPUT = "input"
#: Frames that are evaluated together; memory only, the numbers do not depend on it.
_TOGETHER = 32


class NetworkFileError(ValueError):
    """A file holds no network that can be evaluated; the message names file and fault."""


@dataclass(frozen=True)
class Layer:
    """One operation of a network.

    Attributes
    ----------
    name
        By which later layers name its output.
    operation
        ``convolution`` (odd square kernel, zeros beyond the edge), ``dense`` (of all that a frame
        has), ``relu``, ``maximum`` and ``mean`` (pools of 2 x 2), ``double`` (each pixel four
        times), ``concatenate`` (of channels).
    inputs
        Names of the layers whose outputs it takes, `INPUT` for the frames.
    shape
        Of its weights: (out, in, k, k) of a convolution, (out, in) of a dense layer.
    """

    name: str
    operation: str
    inputs: tuple[str, ...]
    shape: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.operation not in OPERATIONS:
            known = ", ".join(OPERATIONS)
            raise ValueError(f"layer {self.name}: no operation {self.operation!r}; {known}")
        sizes = {"convolution": 4, "dense": 2}.get(self.operation, 0)
        if len(self.shape) != sizes or any(size < 1 for size in self.shape):
            raise ValueError(f"layer {self.name}: weights of {self.operation} are not {self.shape}")
        if sizes == 4 and not (self.shape[2] == self.shape[3] and self.shape[2] % 2):
            raise ValueError(f"layer {self.name}: kernels are odd and square; got {self.shape}")


def convolution(weight: Floats32, bias: Floats32, of: Floats32) -> Floats32:
    """Correlate frames (N, C, H, W) with kernels (O, C, k, k): (N, O, H, W), as frameworks do."""
    count, channels, rows, columns = of.shape
    out, size = weight.shape[0], weight.shape[2]
    margin = size // 2
    padded = np.pad(of, ((0, 0), (0, 0), (margin, margin), (margin, margin)))
    parts = [padded[:, :, i : i + rows, j : j + columns] for i in range(size) for j in range(size)]
    stacked = np.stack(parts, axis=2).reshape(count, channels * size**2, rows * columns)
    found = weight.reshape(out, -1) @ stacked + bias[:, None]
    return np.asarray(found.reshape(count, out, rows, columns))


def dense(weight: Floats32, bias: Floats32, of: Floats32) -> Floats32:
    """Return ``weight @ x + bias`` of each frame's values in order of channel, row, column."""
    return np.asarray(of.reshape(len(of), -1) @ weight.T + bias)


def _blocks(of: Floats32) -> Floats32:
    """Return pixels (N, C, H/2, 2, W/2, 2); an odd last row or column is left out."""
    count, channels, rows, columns = of.shape
    even = of[:, :, : rows // 2 * 2, : columns // 2 * 2]
    return even.reshape(count, channels, rows // 2, 2, columns // 2, 2)


#: What layers without weights do with their inputs, and those with weights, by name.
_PLAIN: Mapping[str, Callable[..., Floats32]] = MappingProxyType(
    {
        "relu": lambda of: np.maximum(of, np.float32(0.0)),
        "maximum": lambda of: _blocks(of).max(axis=(3, 5)),
        "mean": lambda of: _blocks(of).mean(axis=(3, 5), dtype=np.float32),
        "double": lambda of: of.repeat(2, axis=2).repeat(2, axis=3),
        "concatenate": lambda *of: np.concatenate(of, axis=1),
    }
)
_WEIGHTED = MappingProxyType({"convolution": convolution, "dense": dense})
OPERATIONS = (*_WEIGHTED, *_PLAIN)


@dataclass(frozen=True)
class Network:
    """Layers with weights.

    Attributes
    ----------
    layers
        In the order they are evaluated; the last one's output is the network's.
    weights
        By layer: weight and bias, float32.
    card
        Plain JSON: what it was trained on, seeds, framework, loss.
    """

    layers: tuple[Layer, ...]
    weights: Mapping[str, tuple[Floats32, Floats32]]
    card: Mapping[str, Any]

    def __post_init__(self) -> None:
        known = {INPUT}
        for layer in self.layers:
            if missing := [name for name in layer.inputs if name not in known]:
                raise ValueError(f"layer {layer.name}: no layer {missing[0]!r} before it")
            if not layer.inputs or layer.name in known:
                raise ValueError(f"layer {layer.name}: without inputs, or there twice")
            known.add(layer.name)
        if not self.layers or {one.name for one in self.layers if one.shape} != set(self.weights):
            raise ValueError("a network has weights for exactly the layers that need some")
        for layer in self.layers:
            if layer.shape:
                self._check(layer)

    def _check(self, layer: Layer) -> None:
        weight, bias = self.weights[layer.name]
        found = (*weight.shape, *bias.shape)
        if found != (*layer.shape, layer.shape[0]) or not weight.dtype == bias.dtype == np.float32:
            raise ValueError(
                f"layer {layer.name}: expected float32 weights {layer.shape} and a bias each; got "
                f"{weight.dtype} {weight.shape} and {bias.dtype} {bias.shape}"
            )
        if not (np.isfinite(weight).all() and np.isfinite(bias).all()):
            raise ValueError(f"layer {layer.name}: weights that are not finite")

    @property
    def parameters(self) -> int:
        """Number of weights and biases."""
        return sum(weight.size + bias.size for weight, bias in self.weights.values())

    def __call__(self, frames: NDArray[Any]) -> Floats32:
        """Evaluate frames (N, C, H, W), or (N, H, W) of one channel: what the last layer gives.

        ValueError for frames of another number of axes or channels, or of none.
        """
        given = np.asarray(frames, dtype=np.float32)
        given = given[:, None] if given.ndim == 3 else given
        if given.ndim != 4 or not len(given):
            raise ValueError(f"frames must be (N, C, H, W); got {np.shape(frames)}")
        parts = [
            self._one(given[start : start + _TOGETHER]) for start in range(0, len(given), _TOGETHER)
        ]
        return np.concatenate(parts)

    def _one(self, frames: Floats32) -> Floats32:
        outputs = {INPUT: frames}
        for layer in self.layers:
            of = [outputs[name] for name in layer.inputs]
            if layer.shape:
                weight, bias = self.weights[layer.name]
                channels = of[0].shape[1] if len(layer.shape) == 4 else math.prod(of[0].shape[1:])
                if channels != layer.shape[1]:
                    raise ValueError(f"layer {layer.name} takes {layer.shape[1]}; got {channels}")
                outputs[layer.name] = _WEIGHTED[layer.operation](weight, bias, *of)
            else:
                outputs[layer.name] = _PLAIN[layer.operation](*of)
        return outputs[self.layers[-1].name]

    def save(self, path: Path) -> None:
        """Write the file, whole or not at all; the same network gives the same bytes."""
        card = {**self.card, "layers": [vars(layer) for layer in self.layers]}
        text = json.dumps(card, allow_nan=False, sort_keys=True)
        arrays: dict[str, NDArray[Any]] = {"card": np.frombuffer(text.encode(), dtype=np.uint8)}
        for name, (weight, bias) in sorted(self.weights.items()):
            arrays |= {f"{name}.weight": weight, f"{name}.bias": bias}
        held = BytesIO()
        np.savez(held, allow_pickle=False, **arrays)  # members dated 1980: the same bytes
        replace_file(path, held.getvalue())

    @classmethod
    def load(cls, path: Path) -> Network:
        """Read a file that `save` wrote; NetworkFileError naming what is wrong with it."""
        try:
            with np.load(path, allow_pickle=False) as held:
                arrays = {name: held[name] for name in held.files}
            card = json.loads(arrays.pop("card").tobytes())
            layers = tuple(_layer(one) for one in card.pop("layers"))
            weights = {
                layer.name: (arrays.pop(f"{layer.name}.weight"), arrays.pop(f"{layer.name}.bias"))
                for layer in layers
                if layer.shape
            }
            network = cls(layers, MappingProxyType(weights), MappingProxyType(card))
        except FileNotFoundError as error:
            raise NetworkFileError(f"{path}: there is no such network") from error
        except KeyError as error:
            raise NetworkFileError(f"{path}: has no {error}") from error
        except (ValueError, TypeError, AttributeError, OSError, zipfile.BadZipFile) as error:
            raise NetworkFileError(f"{path}: {error}") from error
        if arrays:
            raise NetworkFileError(f"{path}: arrays of no layer: {', '.join(sorted(arrays))}")
        return network


def _layer(of: Mapping[str, Any]) -> Layer:
    return Layer(of["name"], of["operation"], tuple(of["inputs"]), tuple(of["shape"]))


def chained(*steps: tuple[str, str, tuple[int, ...]], of: str = INPUT) -> Iterator[Layer]:
    """Yield layers (name, operation, shape of weights), each of the one before."""
    for name, operation, shape in steps:
        yield Layer(name, operation, (of,), shape)
        of = name


def convolutions(name: str, channels: Sequence[int], of: str, size: int = 3) -> Iterator[Layer]:
    """Yield convolutions each with a ReLU behind: ``NAME0``, ``NAME0.relu``, ``NAME1``, ...

    `channels` are those that come in, then those of each convolution.
    """
    for k, (before, after) in enumerate(pairwise(channels)):
        yield Layer(f"{name}{k}", "convolution", (of,), (after, before, size, size))
        of = f"{name}{k}.relu"
        yield Layer(of, "relu", (f"{name}{k}",))
