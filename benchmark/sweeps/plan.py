"""Which reference series each extractor is measured on, and why not on the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from algorithms.contract import Extractor, FeatureKind, Observation, UnsuitableDesignError
from benchmark.datasets import Preset
from benchmark.datasets.standard import ccd_lens, cmos_lens
from benchmark.simulator.sensors.black_sun import BlackSunSensor
from benchmark.simulator.sensors.blooming import BloomingSensor
from benchmark.sweeps.points import Point
from benchmark.synthetic_features.cameras import CameraSeries
from benchmark.synthetic_features.events import EVENTS
from benchmark.synthetic_features.frame_series import FramesSeries
from benchmark.synthetic_features.lines import SLIT, SLITS
from benchmark.synthetic_features.readings import FacesSeries, QuadrantSeries
from benchmark.synthetic_features.series import Series, SeriesPoint
from benchmark.synthetic_features.spots import DiscSeries, GridSeries


def _camera_of(preset: Preset, name: str, description: str) -> CameraSeries:
    """Return the series of a dataset's nominal camera."""
    camera = preset.condition("nominal").sensor
    if not isinstance(camera, BloomingSensor | BlackSunSensor):
        raise TypeError(f"{preset.name} has no lens camera; got {type(camera).__name__}")
    return CameraSeries(name, camera, preset.geometry, description)


_ALL: tuple[Series, ...] = (
    DiscSeries(),
    FramesSeries(),
    GridSeries(),
    SLIT,
    SLITS,
    QuadrantSeries(),
    FacesSeries(),
    EVENTS,
    _camera_of(
        ccd_lens.PRESET,
        "blooming",
        "the Sun through a lens on a CCD without drains, trails along the columns: the nominal "
        "`ccd-lens` camera without distortion; the SNR is that of a pixel at the full well",
    ),
    _camera_of(
        cmos_lens.PRESET,
        "black-sun",
        "the Sun through a lens on a CMOS array that inverts: the nominal `cmos-lens` camera "
        "without distortion; the SNR is that of a pixel at the full well",
    ),
)

#: By name, in the order of the tables.
SERIES: Mapping[str, Series] = MappingProxyType({series.name: series for series in _ALL})

#: Methods whose feature is not one disc in a frame.
_FRAMES_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("MCAM", "FEIC", "FMMS"), ("grid",)),
        "BSCM": ("black-sun",),
        "HT": ("disc", "frames", "blooming", "black-sun"),
    }
)
_SERIES_OF: Mapping[Observation, tuple[str, ...]] = MappingProxyType(
    {
        Observation.FRAMES: ("disc", "frames", "grid"),
        Observation.PROFILES: ("slit", "slits"),
        Observation.EVENTS: ("event-l-slit",),
    }
)
_READINGS_OF: Mapping[FeatureKind, tuple[str, ...]] = MappingProxyType(
    {FeatureKind.BALANCE: ("quadrants",), FeatureKind.SIGNALS: ("faces",)}
)
#: What is no estimate of a place: lists of spots, readings of pixels.
_UNMEASURED = frozenset({FeatureKind.SPOTS, FeatureKind.SIGNALS})


@dataclass(frozen=True)
class SweepPlan:
    """What is measured: settings by point, and why there is none; on a whole series in one line."""

    settings: Mapping[Point, SeriesPoint]
    refused: Mapping[Point, str]


def plan_points(extractors: Mapping[str, type[Extractor]]) -> SweepPlan:
    """Return every point of every extractor, and what is refused with the reason.

    Where a method refuses a whole series, sweep and point of the refusal are empty.
    """
    settings: dict[Point, SeriesPoint] = {}
    refused: dict[Point, str] = {}
    for extractor in extractors.values():
        names = _series_names(extractor)
        if not names:
            about = extractor.about
            reason = f"no reference series of {about.observation} that are read as {about.kind}"
            refused[Point("", "", "", extractor.about.name)] = reason
        for series in (SERIES[name] for name in names):
            accepted, left_out = _sorted_out(series, extractor)
            settings |= accepted
            if accepted:
                refused |= left_out
            else:  # one line instead of one a point
                reason = next(iter(left_out.values()))
                refused[Point(series.name, "", "", extractor.about.name)] = reason
    return SweepPlan(dict(sorted(settings.items())), dict(sorted(refused.items())))


def _sorted_out(
    series: Series, extractor: type[Extractor]
) -> tuple[dict[Point, SeriesPoint], dict[Point, str]]:
    """Return the points whose design a method accepts, and reasons for the others."""
    # a method for one spot meets the grid only to say what several features do for it
    visiting = series.name == "grid" and "grid" not in _FRAMES_OF.get(extractor.about.taxonomy, ())
    accepted: dict[Point, SeriesPoint] = {}
    left_out: dict[Point, str] = {}
    for setting in series.settings():
        if visiting and setting.sweep != "features":
            continue
        point = Point(series.name, setting.sweep, setting.point, extractor.about.name)
        if reason := _refusal(series, setting, extractor):
            left_out[point] = reason
        else:
            accepted[point] = setting
    return accepted, left_out


def _series_names(extractor: type[Extractor]) -> tuple[str, ...]:
    if extractor.about.observation is Observation.FRAMES and extractor.about.taxonomy in _FRAMES_OF:
        return _FRAMES_OF[extractor.about.taxonomy]
    if extractor.about.observation is Observation.CURRENTS:
        return _READINGS_OF.get(extractor.about.kind, ())
    if extractor.about.kind in _UNMEASURED:
        return ()
    return _SERIES_OF[extractor.about.observation]


def _refusal(series: Series, setting: SeriesPoint, extractor: type[Extractor]) -> str:
    """Why a method does not fit the design of a point, or empty."""
    geometry = series.geometry(setting)
    missing = [name for name in extractor.about.needs if getattr(geometry, name) is None]
    if missing:
        return f"needs {', '.join(missing)}; the series has none"
    try:
        extractor.for_sensor(geometry)
    except UnsuitableDesignError as error:
        return str(error)
    except Exception:  # noqa: BLE001 - a defect: planned, so that its row says what failed
        return ""
    return ""
