"""What data sets show, as the registry needs it."""

from __future__ import annotations

from collections.abc import Mapping

from benchmark.plan.parts import Parts, installed_parts
from registry.fidelity.purposes import DataSet


def data_sets(*, parts: Parts | None = None) -> Mapping[str, DataSet]:
    """Return conditions, columns and studies of every data set, by its name."""
    return {
        name: DataSet(
            name,
            tuple(preset.conditions),
            frozenset(preset.context_columns),
            tuple(getattr(preset, "follows", ())),  # a card's field, and no part of the protocol
        )
        for name, preset in (parts or installed_parts()).presets.items()
    }
