"""Which standard data set a reader's sensor behaves like, by how models rank on both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Models that both must have: of fewer, some data set has the same ratios by chance.
_FEWEST = 4


@dataclass(frozen=True)
class Likeness:
    """A standard data set beside the reader's own data.

    `factor` is that by which errors of models, over their middle one, typically differ from the
    reader's: 1 is the same.
    """

    dataset: str
    detector: str
    mask: str
    extractor: str  # whose features its models read
    factor: float
    errors_deg: Mapping[str, float]  # own error there by model


def alike(
    errors_deg: Mapping[str, float], nominal: Mapping[tuple[str, str, str], Mapping[str, Any]]
) -> list[Likeness]:
    """Return the standard data sets, the one where models rank most alike first.

    Of published scores by data set, extractor and model, with `own_deg`; none where fewer than four
    models answer on both. Only ratios between models count: a sensor with ten times the noise
    behaves alike where noise is not what tells models apart.
    """
    mine = {name: error for name, error in errors_deg.items() if error > 0}
    theirs: dict[tuple[str, str], dict[str, Mapping[str, Any]]] = {}
    for (dataset, extractor, model), row in nominal.items():
        if model in mine and row["status"] == "ok" and row["own_error_deg"]:
            theirs.setdefault((dataset, extractor), {})[model] = row
    best: dict[str, Likeness] = {}
    for (dataset, extractor), rows in theirs.items():
        names = sorted(rows)
        if len(names) < _FEWEST:
            continue
        own = np.log([mine[name] for name in names])
        other = np.log([rows[name]["own_error_deg"] for name in names])
        apart = (own - np.median(own)) - (other - np.median(other))
        first = rows[names[0]]
        found = Likeness(
            dataset, first["detector"], first["mask"], extractor,
            float(np.exp(np.sqrt(np.mean(apart**2)))),
            {name: float(rows[name]["own_error_deg"]) for name in names},
        )  # fmt: skip
        if dataset not in best or found.factor < best[dataset].factor:
            best[dataset] = found
    return sorted(best.values(), key=lambda one: one.factor)
