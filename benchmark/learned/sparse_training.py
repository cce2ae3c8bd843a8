"""Training of SSCNN, on several units or on one, and on how many frames."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark import datasets
from benchmark.learned.centres import Look, windows
from benchmark.learned.frames import VALIDATION, Unit
from benchmark.learned.limits import limits_of
from benchmark.learned.network import Floats32, Network
from benchmark.learned.sparse import HEADS, LIT, SparseReader, layers
from benchmark.learned.training import Recipe, torch, train

#: The data set: a window of a CMOS frame behind one hole, lit in few of its pixels.
DATASET, LOOK = "cmos-single-aperture", Look(24, 15)
#: Steps of training, and frames a step.
STEPS, BATCH = 25_000, 16
#: Networks of the ablation, which learn from frames of a scored unit: how many, in how many steps.
OF_ONE = ((441, STEPS // 10), (3200, STEPS // 10), (3200, STEPS))
#: Frames of each training unit.
FRAMES = 400


def name_of_one(frames: int, steps: int) -> str:
    """Name a network of the ablation."""
    return f"sscnn-one-unit-{frames}" + ("-long" if steps == STEPS else "")


def scaling() -> tuple[tuple[float, float], float]:
    """Return the detector's middle and half width, px."""
    detector: Any = Unit(datasets.get(DATASET)).sensor.detector
    x, y = detector.centre_px
    return (float(x), float(y)), detector.columns / 2.0


def examples(units: Any, count: int, *names: str) -> tuple[Floats32, Floats32]:
    """Return windows (N, 1, S, S), and (N, 4): their first pixel, scaled, and true angles, deg."""
    light, aims = [], []
    (x, y), scale = scaling()
    for number in units:
        unit = Unit(datasets.get(DATASET).for_unit(number))
        taken = unit.taken(unit.scene(count, *names), *names)
        shown = windows(LOOK, taken.corrected)
        first = (shown.corner + taken.origin_px - [x, y]) / scale
        light.append(shown.light)
        aims.append(np.column_stack([first, angles_deg(taken.sun)]))
    return np.concatenate(light), np.concatenate(aims).astype(np.float32)


def angles_deg(sun: Floats) -> Floats:
    """(N, 2) beta and alpha of Suns (N, 3)."""
    return np.degrees(np.arctan(sun[:, :2] / sun[:, 2:]))


def train_sparse(
    name: str, learned: tuple[Floats32, Floats32], card: dict[str, Any], steps: int = STEPS
) -> Network:
    """Train a network, of dense windows whose pixels that are not lit are held at zero."""
    at, made = torch(), layers()
    side, (_, scale) = LOOK.window_px, scaling()
    along = at.arange(side, dtype=at.float32) / scale

    def angles(weights: Any, light: Any, first: Any) -> Any:
        lit = (light > LIT).to(at.float32)
        values, functions = light * lit, at.nn.functional
        for k in range(3):
            found = functions.conv2d(values, *weights[f"site{k}"], padding=1)
            values = found.relu() * lit
        logits = functions.conv2d(values, *weights["heads"])
        most = logits.amax(dim=(2, 3), keepdim=True).detach()
        shares = (logits - most).exp() * lit * light
        shares = shares / shares.sum(dim=(2, 3), keepdim=True)
        means = at.cat(
            [
                shares.sum(dim=2) @ along + first[:, :1].expand(-1, HEADS),
                shares.sum(dim=3) @ along + first[:, 1:].expand(-1, HEADS),
            ],
            dim=1,
        )
        bent = means
        for layer in ("hidden0", "hidden1"):
            bent = functions.linear(bent, *weights[layer]).relu()
        tangents = functions.linear(means, *weights["linear"])
        return at.rad2deg((tangents + functions.linear(bent, *weights["angles"])).atan())

    def run(_: Any, weights: Any, given: Any) -> Any:
        return angles(weights, given[:, :1], given[:, 1, 0, :2])

    light, aims = learned
    first = np.zeros_like(light)
    first[:, 0, 0, :2] = aims[:, :2]
    given = np.concatenate([light, first], axis=1)
    epochs = -(-steps * BATCH // len(light))
    return train(
        name, made, given, aims[:, 2:], loss=at.nn.functional.mse_loss,
        recipe=Recipe(epochs, BATCH, 3e-3), card=card, run=run, last=0.1,
    )  # fmt: skip


def validated(network: Network) -> Network:
    """Return a network with its error on validation units, and the limits that these set."""
    middle, scale = scaling()
    reader, errors, statistics = SparseReader(network, LOOK, middle, scale), [], []
    for number in VALIDATION:
        unit = Unit(datasets.get(DATASET).for_unit(number))
        taken = unit.taken(unit.scene(200, "validate"), "validate")
        tangents, said = reader.read(taken.corrected, taken.origin_px)
        errors.append(np.degrees(np.arctan(tangents)) - angles_deg(taken.sun))
        statistics.append(said)
    off = np.concatenate(errors)
    card = {
        **network.card,
        "validation_deg": [float(f"{v:.4g}") for v in np.sqrt((off**2).mean(axis=0))],
        "limits": limits_of(np.concatenate(statistics)),
    }
    return Network(network.layers, network.weights, card)
