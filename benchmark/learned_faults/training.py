"""Training of the sparse network on clean and faulty frames of units that are never scored."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import chain
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark import datasets
from benchmark.learned.frames import TRAINING, VALIDATION, Frames
from benchmark.learned.limits import limits_of
from benchmark.learned.network import Floats32, Network
from benchmark.learned.sparse import LIT
from benchmark.learned.sparse_training import angles_deg
from benchmark.learned.training import Recipe, torch, train
from benchmark.learned_faults.deep import LOOK, WIDTHS, DeepReader, layers, places, shown
from benchmark.learned_faults.frames import GROUP, FaultyUnit
from benchmark.learned_faults.rule import DATASET, FAULTS
from benchmark.seeds import generator

#: Groups of frames of each training unit and fault, and of none.
GROUPS = 20
#: Groups of each unit of validation.
_VALIDATED = 5
#: Passes over all frames, frames a step, first step's size.
RECIPE = Recipe(16, 16, 3e-3)


def drawn(units: Iterable[int], groups: int, name: str) -> Iterator[tuple[str, Frames]]:
    """Yield groups of frames by fault, "" for none: strengths evenly up to the largest scored."""
    for number in units:
        unit = FaultyUnit(datasets.get(DATASET).for_unit(number))
        for fault in ("", *FAULTS):
            most = max(FAULTS.get(fault, (0.0,)))
            for group in range(groups):
                named = name, fault or "none", group
                strength = most * generator("learned", number, *named, "strength").random()
                yield fault, unit.struck(fault, strength, GROUP, *named)


def trained_anew() -> Network:
    """Return the network with its errors and limits: the same digits on the same machine."""
    pairs: dict[str, list[tuple[Floats32, Any]]] = {fault: [] for fault in ("", *FAULTS)}
    for fault, one in drawn(TRAINING, GROUPS, "train"):
        pairs[fault].append((shown(one.corrected)[0], angles_deg(one.sun)))
    light, aims = map(np.concatenate, zip(*chain.from_iterable(pairs.values()), strict=True))
    card = {"data set": DATASET, "units": [TRAINING.start, TRAINING.stop - 1]}
    made = train(
        "sscnn cmos-encoded", layers(), light, aims.astype(np.float32),
        loss=_loss, recipe=RECIPE, card=card, augment=_mirrored, run=_run, last=0.1,
    )  # fmt: skip
    return validated(made)


def _loss(found: Any, wanted: Any) -> Any:
    """Mean error of the angles; and of the deviation that is stated, as of Laplace's law."""
    off = (found[:, :2] - wanted).abs().sum(dim=1)
    stated = found[:, 2]
    return (off + off.detach() * (-stated).exp() + 2.0 * stated).mean()


def _mirrored(
    stream: np.random.Generator, light: Floats32, aims: Floats32
) -> tuple[Floats32, Floats32]:
    """Exchange both axes of half of the frames: the code is the same along either."""
    turned = stream.random(len(light)) < 0.5
    light, aims = light.copy(), aims.copy()
    light[turned] = light[turned].transpose(0, 1, 3, 2)
    aims[turned] = aims[turned, ::-1]
    return light, aims


def _run(_: Any, weights: dict[str, Any], light: Any) -> Any:
    """Evaluate on dense windows whose pixels that are not lit are held at zero."""
    at = torch()
    functions = at.nn.functional
    lit = (light > LIT).to(at.float32)
    values = light * lit
    for level in range(len(WIDTHS)):
        if level:
            values, lit = functions.max_pool2d(values, 2), functions.max_pool2d(lit, 2)
        for k in range(2):
            found = functions.conv2d(values, *weights[f"level{level}_{k}"], padding=1)
            values = found.relu() * lit
    logits = functions.conv2d(values, *weights["heads"])
    most = logits.masked_fill(lit == 0, -at.inf).amax(dim=(2, 3), keepdim=True).detach()
    shares = (logits - most).clamp(max=0.0).exp() * lit
    shares = shares / shares.sum(dim=(2, 3), keepdim=True)
    along = at.from_numpy(places(LOOK.window_px >> (len(WIDTHS) - 1)))
    x, y = shares.sum(dim=2) @ along, shares.sum(dim=3) @ along
    averaged = at.einsum("nhij,ncij->nhc", shares, values)
    means = at.cat([x[:, :, None], y[:, :, None], averaged], dim=2).reshape(len(light), -1)
    bent = means
    for name in ("hidden0", "hidden1"):
        bent = functions.linear(bent, *weights[name]).relu()
    found = functions.linear(bent, *weights["angles"])
    tangents = found[:, :2] + functions.linear(means, *weights["linear"])
    return at.cat([at.rad2deg(tangents.atan()), found[:, 2:]], dim=1)


def validated(network: Network) -> Network:
    """Return a network with its errors on units of validation, and the limits that these set.

    Light may be as under any fault; the deviation that is stated, as of clean frames.
    """
    reader, off, said = DeepReader(network), defaultdict(list), defaultdict(list)
    for fault, one in drawn(VALIDATION, _VALIDATED, "validate"):
        tangents, statistics = reader.read(one.corrected)
        off[fault].append(np.degrees(np.arctan(tangents)) - angles_deg(one.sun))
        said[fault].append(statistics)
    errors = {fault or "none": _sizes(np.concatenate(parts)) for fault, parts in off.items()}
    every = np.concatenate(list(chain.from_iterable(said.values())))
    limits = [*limits_of(every)[:2], *limits_of(np.concatenate(said[""]))[2:]]
    card = {**network.card, "validation_deg": errors, "limits": limits}
    return Network(network.layers, network.weights, card)


def _sizes(off: Floats) -> list[float]:
    """Return root mean square and median of an angle's errors."""
    return [float(f"{v:.4g}") for v in (np.sqrt((off**2).mean()), np.median(np.abs(off)))]
