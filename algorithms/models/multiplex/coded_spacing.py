"""Coded masks read by the spacings of neighbouring spots (Coded)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.models.multiplex.coded_mask import NEEDS, CodedMask


@dataclass
class CodedSpacing(CodedMask):
    """Sub-field."""

    about: ClassVar = AboutModel(
        name="coded-spacing",
        taxonomy="Coded",
        studies=("Wei2013", "Wei2014", "Wang2015", "Wei2017"),
        labels=("model:multiplex", "model:code"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOTS}),
    )

    def search(self) -> object:
        """Return the search among the places that rare spacings name."""
        from algorithms.models.multiplex.code_kernel import search_spacings  # noqa: PLC0415 - Numba

        return search_spacings
