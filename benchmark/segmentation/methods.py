"""Methods that find the Sun in a frame: thresholds, templates, extractors, a network's masks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats
from algorithms.extractors.frames.centroid import BasicCentroid, ThresholdedCentroid
from algorithms.extractors.frames.line_windows import LineWindows
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.extractors.frames.multi_spot.windowed_list import WindowedList
from algorithms.extractors.frames.template import TemplateMatch
from algorithms.models.geometric.bare_detector import BareDetector
from algorithms.models.multiplex.coded_places import CodedPlaces
from algorithms.pipeline import Pipeline, in_detector_coordinates
from benchmark.segmentation.frames import FaultyUnit
from benchmark.segmentation.masks import (
    Marked,
    Masks,
    NetworkMasks,
    Pixels,
    above_dark,
    above_share,
    discs,
)
from benchmark.segmentation.unet import trained

#: Share of the peak of the fixed threshold.
_SHARE = 0.5
_DARK, _HALF, _NETWORK = "dark", "half", "network"


class Board(NamedTuple):
    """A data set: who leads its record, what reads masks plainly, and the model behind all.

    `frames` are those of each fault on units that score, and on units that choose.
    """

    leader: type[Extractor]
    plain: type[Extractor]
    model: Scored
    frames: tuple[int, int]


BOARDS: Mapping[str, Board] = MappingProxyType(
    {
        "cmos-single-aperture": Board(MirrorRegistration, BasicCentroid, BareDetector, (300, 40)),
        "cmos-l-slit": Board(LineWindows, BasicCentroid, BareDetector, (300, 40)),
        "cmos-encoded": Board(WindowedList, SpotList, CodedPlaces, (80, 20)),
    }
)


class Read(NamedTuple):
    """Directions (N, 3) that are answered without a flag, NaN else; masks, None without."""

    answers: Floats
    masks: Pixels | None


@dataclass
class Method:
    """One way to read frames.

    Attributes
    ----------
    name, learned
        As the record has it; whether a network is in it.
    extractor
        Of the frames, or of what is left of them under a mask.
    masked
        Whose masks, None for none.
    cut
        Whether nothing is left beside the mask, or the background.
    outline
        Masks that an extractor draws by itself, of frames and its features.
    """

    name: str
    extractor: Extractor
    masked: str | None = None
    cut: bool = False
    outline: Callable[[Floats, Floats], Pixels] | None = None
    pipeline: Pipeline = field(init=False)

    @property
    def learned(self) -> bool:
        """Whether a network marks its pixels."""
        return self.masked == _NETWORK

    def features(
        self, frames: Floats, marked: Mapping[str, Marked]
    ) -> tuple[Floats, Pixels | None]:
        """Features (N, F) in the frame, NaN where they are flagged or the mask is refused."""
        if self.masked is None:
            found = self.extractor.measure(frames)
            features = np.where(found.flags[:, None] != 0, np.nan, found.features)
            return features, None if self.outline is None else self.outline(frames, features)
        under = marked[self.masked]
        found = self.extractor.measure(under.cut_out if self.cut else under.without_others)
        bad = (found.flags != 0) | under.refused
        return np.where(bad[:, None], np.nan, found.features), under.pixels


class Bench:
    """The methods of a data set, calibrated on clean frames of one unit."""

    def __init__(self, unit: FaultyUnit) -> None:
        preset = unit.preset
        clean, sun, origin = unit.calibration()
        geometry = preset.geometry_for(preset.conditions[0])
        model = BOARDS[preset.name].model
        self._network = NetworkMasks(trained(preset.name)).calibrated(clean)
        self.methods = list(_methods(preset.name, geometry))
        marked = self._marked(clean)
        for method in self.methods:
            kind = method.extractor.about.kind
            method.pipeline = Pipeline(method.extractor, model.for_sensor(geometry, kind))
            features, _ = method.features(clean, marked)
            placed = in_detector_coordinates(features, kind, origin)
            method.pipeline.fit_features(placed, sun)

    def _marked(self, frames: Floats) -> Mapping[str, Marked]:
        masks = {_DARK: above_dark(frames), _NETWORK: self._network(frames)}
        if any(method.masked == _HALF for method in self.methods):
            half = above_share(frames, _SHARE)
            masks[_HALF] = Masks(half, np.asarray(~half.any(axis=(1, 2))))
        return {name: Marked.of(frames, one) for name, one in masks.items()}

    def read(self, frames: Floats, origin: NDArray[np.int64]) -> dict[str, Read]:
        """Read frames by every method."""
        marked, found = self._marked(frames), {}
        for method in self.methods:
            features, pixels = method.features(frames, marked)
            placed = in_detector_coordinates(features, method.extractor.about.kind, origin)
            found[method.name] = Read(method.pipeline.predict_features(placed), pixels)
        return found


def _methods(board: str, geometry: Any) -> list[Method]:
    leader, plain, _, _ = BOARDS[board]
    lead, name = leader.for_sensor(geometry), leader.about.name
    basic = plain.for_sensor(geometry)
    single, spot = plain is BasicCentroid, geometry.aperture_shape is not None
    found = [Method(name, lead), Method(f"threshold, {name}", lead, _DARK)]
    if single:
        fixed = ThresholdedCentroid(threshold=_SHARE, background="median")
        share = partial(above_share, share=_SHARE)
        found += [
            Method("fixed threshold", fixed, outline=lambda frames, _: share(frames)),
            Method(
                "adaptive threshold",
                ThresholdedCentroid(),
                outline=lambda frames, _: above_dark(frames).pixels,
            ),
            Method(f"threshold, {plain.about.name}", basic, _HALF, cut=True),
        ]
        if spot:
            template = TemplateMatch.for_sensor(geometry)
            radius = template.width_px / 2.0
            found.append(
                Method("template", template, outline=lambda frames, at: discs(frames, at, radius))
            )
    else:
        found.append(Method(plain.about.name, basic))
    found += [
        Method(f"U-Net, {plain.about.name}", basic, _NETWORK, cut=single),
        Method(f"U-Net, {name}", lead, _NETWORK),
    ]
    return found
