"""Training of heat maps on simulated units that are never scored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark import datasets
from benchmark.learned.centres import (
    MARGIN_PX,
    CentreReader,
    Look,
    folded,
    layers,
    windows,
)
from benchmark.learned.frames import TRAINING, VALIDATION, Frames, Unit
from benchmark.learned.limits import limits_of
from benchmark.learned.network import Floats32, Network
from benchmark.learned.training import Recipe, torch, train


@dataclass(frozen=True)
class Plan:
    """What the network of a data set is shown, on how many frames a unit it learns, and how.

    `corner_mm` is the place in the mask, on both axes, whose image is the centre that is learned.
    With `robust_px` errors far beyond it count by their size, not their square: where frames at
    the edge of the field are faint, they would drown all others.
    """

    look: Look
    frames: int
    recipe: Recipe
    corner_mm: float = 0.0
    robust_px: float = 0.0


def examples(plan: Plan, name: str, units: Any, count: int) -> tuple[Floats32, Floats32]:
    """Return windows (N, 1, S + 2 m, S + 2 m) of drawn frames, and true centres (N, 2) in them."""
    light, centres = [], []
    for number in units:
        unit = Unit(datasets.get(name).for_unit(number))
        taken = unit.taken(unit.scene(count, "train"), "train")
        shown = windows(plan.look, taken.corrected, MARGIN_PX)
        light.append(shown.light)
        centres.append(_pooled(plan.look, true_centres(unit, taken, plan.corner_mm)) - shown.corner)
    return np.concatenate(light), np.concatenate(centres).astype(np.float32)


def true_centres(unit: Unit, taken: Frames, corner_mm: float = 0.0) -> Floats:
    """(N, 2) true places of the image, in the frame, of a place in the mask."""
    spots = unit.spot_px(taken.sun)
    if corner_mm:
        spots = spots + corner_mm / unit.sensor.detector.pitch_mm
    return spots if taken.origin_px is None else np.asarray(spots - taken.origin_px)


def _pooled(look: Look, places: Floats) -> Floats:
    return np.asarray((places - (look.pool - 1) / 2.0) / look.pool)


def train_centres(name: str, plan: Plan, seed: int, learned: tuple[Floats32, Floats32]) -> Network:
    """Train the network of a data set on examples, from one seed."""
    at, side = torch(), plan.look.window_px
    places = at.arange(side, dtype=at.float32)
    light, centres = learned

    def moved(stream: np.random.Generator, given: Floats32, wanted: Floats32) -> Any:
        by = stream.integers(0, 2 * MARGIN_PX + 1, (len(given), 2))
        shown = np.stack(
            [one[:, y : y + side, x : x + side] for one, (x, y) in zip(given, by, strict=True)]
        )
        aims = (wanted - by).astype(np.float32)
        return folded(shown), np.concatenate([aims, shown.reshape(len(shown), -1)], axis=1)

    def loss(heat: Any, wanted: Any) -> Any:
        half, seen = side // 2, wanted[:, 2:].reshape(-1, 1, side, side).clamp(min=0.0)
        maps = heat.reshape(-1, 2, 2, 2, half, half).permute(0, 1, 4, 2, 5, 3)
        maps = maps.reshape(-1, 2, side * side).softmax(dim=2).reshape(-1, 2, side, side) * seen
        shares = maps / maps.sum(dim=(2, 3), keepdim=True)
        found = (shares[:, 0].sum(dim=1) @ places, shares[:, 1].sum(dim=2) @ places)
        squares = ((at.stack(found, dim=1) - wanted[:, :2]) ** 2).sum(dim=1)
        if plan.robust_px:
            squares = (squares + plan.robust_px**2).sqrt()
        return squares.mean()

    card = {
        "dataset": name,
        "units": [TRAINING.start, TRAINING.stop - 1],
        "units_of_settings": [VALIDATION.start, VALIDATION.stop - 1],
        "window_px": side,
        "box_px": plan.look.box_px,
        "pool": plan.look.pool,
    }
    recipe = Recipe(plan.recipe.epochs, plan.recipe.batch, plan.recipe.rate, seed)
    return train(
        f"centres of {name}", layers(), light, centres,
        loss=loss, recipe=recipe, card=card, augment=moved, last=0.1,
    )  # fmt: skip


def validated(name: str, plan: Plan, network: Network) -> Network:
    """Return the network with its error on validation units, and the limits that these set."""
    reader, errors, statistics = CentreReader(network, plan.look), [], []
    for number in VALIDATION:
        unit = Unit(datasets.get(name).for_unit(number))
        taken = unit.taken(unit.scene(100, "validate"), "validate")
        found, said = reader.read(taken.corrected)
        errors.append(found - true_centres(unit, taken, plan.corner_mm))
        statistics.append(said)
    off, every = np.concatenate(errors), np.concatenate(statistics)
    card = {
        **network.card,
        "validation_px": [float(f"{v:.4g}") for v in np.sqrt((off**2).mean(axis=0))],
        "limits": limits_of(every),
    }
    return Network(network.layers, network.weights, card)
