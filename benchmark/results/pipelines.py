"""Stored scores as recommendations take them: by pipeline, under every condition and unit."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

from benchmark import datasets
from benchmark.datasets.hazards import hazards
from benchmark.metrics.rings import EDGES_DEG, field_error
from benchmark.metrics.score import is_available
from registry.catalogue import catalogue
from registry.fitting import stages
from registry.measured import Measured, Score

_PLAIN = tuple(f.name for f in dataclasses.fields(Score) if f.name not in {"available", "cones"})

Row = Mapping[str, Any]
Place = tuple[str, str, str]


def pipelines(
    rows: Iterable[Row], latency_us: Mapping[Place, float | None] | None = None
) -> list[Measured]:
    """Return what is measured of every pipeline on every standard data set.

    Parameters
    ----------
    rows
        Of the store, of all units. Rows of data sets, conditions and models that there are no
        longer are passed over.
    latency_us
        Of a call with one sample on this machine, by data set, extractor and model.
    """
    by: dict[Place, dict[tuple[str, int], Row]] = {}
    for row in rows:
        place = (row["dataset"], row["extractor"], row["model"])
        by.setdefault(place, {})[row["condition"], row["unit"]] = row
    known = {name: stages(scored) for name, scored in catalogue().models.items()}
    conditions = {name: datasets.get(name).conditions for name in datasets.names()}
    found = []
    for place, scores in by.items():
        dataset, extractor, model = place
        if model not in known or dataset not in conditions:
            continue
        first = scores.get((conditions[dataset][0], 0))
        if first is None:
            continue
        found.append(
            Measured(
                dataset=dataset,
                detector=first["detector"],
                mask=first["mask"],
                extractor=extractor,
                extractor_taxonomy=first["extractor_taxonomy"],
                model=model,
                stages=known[model],
                nominal=_score(first),
                hazards={
                    hazard: tuple(_score(scores[name, 0]) for name in names)
                    for hazard, names in hazards(conditions[dataset]).items()
                    if all((name, 0) in scores for name in names)
                },
                half_fov_deg=first["half_fov_deg"],
                latency_us=(latency_us or {}).get(place),
                unit_rms_deg=tuple(
                    row["rms_deg"]
                    for (condition, unit), row in sorted(scores.items())
                    if condition == first["condition"] and unit and row["rms_deg"] is not None
                ),
            )
        )
    return found


def _score(row: Row) -> Score:
    """Return a score; without an error where the run was refused."""
    half = row["half_fov_deg"]
    cones: list[tuple[float, float | None]] = []
    if half is not None:
        # The last ring may reach beyond the field; all its samples lie within.
        for edge in EDGES_DEG[1:]:
            cones.append((min(float(edge), half), field_error(row, edge)))
            if edge >= half:
                break
    plain: dict[str, Any] = {name: row[name] for name in _PLAIN}
    return Score(**plain, available=is_available(row), cones=tuple(cones))
