"""The fakes as the parts of a plan."""

from __future__ import annotations

from typing import Any

from fake_atlas import Balanced, Currents, Diodes, Framed, Gaps, LeastSquares

from benchmark.plan.parts import Parts


def parts(*models: Any, presets: tuple[Any, ...] = (Diodes(),)) -> Parts:
    extractors = (Currents, Gaps, Framed, Balanced)
    return Parts(
        {preset.name: preset for preset in presets},
        {extractor.about.name: extractor for extractor in extractors},
        {model.about.name: model for model in models or (LeastSquares,)},
    )
