"""Train the masks' networks on simulated units that are never scored; needs the extra `learn`."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from benchmark import datasets
from benchmark.learned.network import Floats32, Network
from benchmark.learned.training import Recipe, torch, train
from benchmark.segmentation.frames import FAULTS, FaultyUnit
from benchmark.segmentation.unet import averaged, channels, layers

#: Units that it learns from; 0 to 9 are scored, `CHECKED` were looked at while this was made.
LEARNED, CHECKED = range(100, 110), range(110, 112)
#: Frames of each fault and unit, by data set: fewer of large ones.
FRAMES: Mapping[str, int] = MappingProxyType(
    {"cmos-single-aperture": 20, "cmos-l-slit": 20, "cmos-encoded": 10}
)
#: Crops of averaged frames that a step sees.
_CROP_PX = 64
#: Frames that a network is shown, each several times: some three minutes.
_SEEN = 10_800


def trained_anew(board: str) -> Network:
    """Return the network of a data set: the same digits on the same machine."""
    given, wanted = [], []
    for number in LEARNED:
        unit = FaultyUnit(datasets.get(board).for_unit(number))
        for fault in FAULTS:
            drawn = unit.drawn(fault, FRAMES[board])
            given.append(channels(drawn.frames))
            wanted.append(averaged(drawn.truth.astype(np.float32)))
    return train(
        f"segmentation {board}",
        tuple(layers()),
        np.concatenate(given),
        np.concatenate(wanted),
        loss=_cross_entropy,
        recipe=Recipe(epochs=_SEEN // sum(map(len, given)), batch=16, rate=4e-3),
        card={"data set": board, "units": [LEARNED.start, LEARNED.stop - 1]},
        augment=_crops,
    )


def _cross_entropy(odds: Any, wanted: Any) -> Any:
    return torch().nn.functional.binary_cross_entropy_with_logits(odds[:, 0], wanted)


def _crops(
    drawn: np.random.Generator, given: Floats32, wanted: Floats32
) -> tuple[Floats32, Floats32]:
    rows, columns = given.shape[2:]
    y = drawn.integers(0, rows - _CROP_PX + 1, len(given))
    x = drawn.integers(0, columns - _CROP_PX + 1, len(given))
    at = [(slice(i, i + _CROP_PX), slice(j, j + _CROP_PX)) for i, j in zip(y, x, strict=True)]
    return (
        np.stack([one[:, i, j] for one, (i, j) in zip(given, at, strict=True)]),
        np.stack([one[i, j] for one, (i, j) in zip(wanted, at, strict=True)]),
    )
