"""Coded masks read by the correlation of spots and apertures (Coded)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.models.multiplex.coded_mask import NEEDS, CodedMask


@dataclass
class CodedCorrelation(CodedMask):
    """Sub-field."""

    about: ClassVar = AboutModel(
        name="coded-correlation",
        taxonomy="Coded",
        studies=("Zhang2021", "Zhang2022a"),
        labels=("model:multiplex", "model:code"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOTS}),
    )

    def search(self) -> object:
        """Return the search for the highest peak of the correlation."""
        from algorithms.models.multiplex.code_kernel import search_correlation  # noqa: PLC0415 - Numba

        return search_correlation
