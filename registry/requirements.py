"""Requirements on a sun sensor: values to include or exclude, and numeric limits."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Self

from registry.taxonomy import ATTRIBUTES, InvalidValueError, Taxonomy, unknown_name

EXCLUDE = "exclude_"

LIMITS: Mapping[str, str] = MappingProxyType(
    {
        "max_error_deg": "a positive number of degrees",
        "min_fov_deg": "a number of degrees above 0, at most 360",
        "min_availability": "a share above 0, at most 1",
        "max_latency_us": "a positive number of microseconds",
    }
)
"""Numeric requirements and what they take. ``min_fov_deg`` is the full field of view."""

SETTINGS: Mapping[str, str] = MappingProxyType(
    {
        "bench_deg": "a number of degrees, 0 or more",
        "confidence": "a share from 0.5 to 0.999",
    }
)
"""Settings of how errors are judged, and their allowed values: the fixed error of the calibration
bench (by default that of each data set's standard bench), and the share of units and benches that
must meet a limit."""

CONFIDENCE = 0.9
"""Default share of units and benches that must meet a limit."""

UNITS = 10
"""Number of sensor units over which a pipeline is judged."""

CLASSES_DEG: Mapping[str, float] = MappingProxyType({"FSS": 0.5, "VFSS": 1 / 60, "UFSS": 10 / 3600})
"""Largest error of each accuracy class of the survey; the coarsest class has no limit."""

HAZARDS: Mapping[str, str] = MappingProxyType(
    {
        "albedo": "sunlight from the Earth, with clouds where they are drawn",
        "missing-apertures": "apertures that are closed, by dirt or in making",
        "ageing": "a detector at the end of its life, dead pixels",
        "temperature": "hot and cold, calibrated at room temperature",
        "misalignment": "turned in its mount and shifted against its mask",
        "glare": "glare, ghosts, stray light and gradients of it",
        "saturation": "an over-exposed detector",
        "spin": "turning during the exposure",
        "noise": "ten times the noise",
    }
)
"""Hazards that a sensor may have to tolerate; `benchmark.datasets.hazards` lists the conditions."""

LISTS = ("survive", "properties")
"""Requirements of which all values must hold: hazards, and properties of the assessment."""

NEEDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "rates": ("rate_deg_s",),
        "time": ("time_s",),
        "temperature": ("temperature_K",),
        "nadir": ("nadir", "nadir_inertial"),
        "magnetic-field": ("magnetic_field_nT", "magnetic_field_inertial_nT"),
        "almanac": ("sun_inertial",),
        "eclipse": ("eclipse",),
        "albedo-flag": ("albedo",),
    }
)
"""Inputs that a calibration may read beside the sensor, and their columns of the context."""

PARAMETERS = (
    *(*ATTRIBUTES, *(EXCLUDE + attribute for attribute in ATTRIBUTES), *LIMITS, *LISTS),
    "exclude_needs",
)
"""Names of all requirements, in reporting order."""

_KNOWN = frozenset((*PARAMETERS, *SETTINGS))


@dataclass(frozen=True)
class Requirements:
    """Requirements on a sensor, its calibration, and the studies behind both.

    Several values of one attribute are alternatives; different attributes must all be met. A
    parent value (ECM, ICM) includes its kinds. Detector, mask, model and extractor are parts of a
    design; task, error and accuracy are attributes of its studies, or of the survey's advice. An
    excluded error or accuracy removes every study that has it; an excluded task removes the
    studies that have no other task.

    Under every hazard of ``survive`` the availability must be high enough, and the error within
    the largest error if there is one. An extractor must have all ``properties`` in the survey's
    assessment, at least partly.
    """

    include: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    exclude: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    max_error_deg: float | None = None
    min_fov_deg: float | None = None  # full field of view
    min_availability: float | None = None
    max_latency_us: float | None = None
    survive: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    exclude_needs: tuple[str, ...] = ()
    bench_deg: float | None = None
    confidence: float | None = None

    @classmethod
    def parse(
        cls, parameters: Mapping[str, object], taxonomy: Taxonomy, properties: Collection[str] = ()
    ) -> Self:
        """Make requirements from named parameters, and check them.

        Parameters
        ----------
        parameters : mapping
            Names of `PARAMETERS`; one or several values for categories, a number for limits. None
            and empty collections are no requirement.
        taxonomy : Taxonomy
        properties : collection of str
            Names of the properties in the survey's assessment.

        Raises
        ------
        InvalidValueError
            For an unknown parameter or value, naming the nearest, or an impossible limit.
        """
        include: dict[str, tuple[str, ...]] = {}
        exclude: dict[str, tuple[str, ...]] = {}
        limits: dict[str, float] = {}
        lists: dict[str, tuple[str, ...]] = {}
        for name, value in parameters.items():
            if name not in _KNOWN:
                raise unknown_name("parameter", name, PARAMETERS)
            if value is None:
                continue
            if name in LIMITS or name in SETTINGS:
                limits[name] = _number(name, value)
                continue
            values = _texts(name, value)
            if name in LISTS or name == "exclude_needs":
                lists[name] = values
            elif values and name.startswith(EXCLUDE):
                exclude[name.removeprefix(EXCLUDE)] = values
            elif values:
                include[name] = values
        requirements = cls(
            MappingProxyType(include),
            MappingProxyType(exclude),
            **limits,
            survive=lists.get("survive", ()),
            properties=lists.get("properties", ()),
            exclude_needs=lists.get("exclude_needs", ()),
        )
        requirements.check(taxonomy, properties)
        return requirements

    def check(self, taxonomy: Taxonomy, properties: Collection[str] = ()) -> None:
        """Raise InvalidValueError unless every attribute, value and limit is possible."""
        for prefix, asked in (("", self.include), (EXCLUDE, self.exclude)):
            for attribute, values in asked.items():
                if attribute not in ATTRIBUTES:
                    raise unknown_name("attribute", attribute, ATTRIBUTES)
                for value in values:
                    taxonomy.require(attribute, value, parameter=prefix + attribute)
        for name in (*LIMITS, *SETTINGS):
            bound = getattr(self, name)
            if bound is not None:
                _number(name, bound)
        lists = (("survive", HAZARDS), ("properties", properties), ("exclude_needs", NEEDS))
        for name, known in lists:
            for value in getattr(self, name):
                if value not in known:
                    raise unknown_name(name, value, known)

    @property
    def largest_deg(self) -> float | None:
        """Largest allowed error: the number, or that of the coarsest required accuracy class."""
        if "accuracy" not in self.include:
            return self.max_error_deg
        classes = [CLASSES_DEG.get(value) for value in self.include["accuracy"]]
        known = [limit for limit in classes if limit is not None]
        by_class = max(known) if known and len(known) == len(classes) else None
        return min((x for x in (self.max_error_deg, by_class) if x is not None), default=None)

    @property
    def draws(self) -> tuple[float | None, float] | None:
        """Bench error and share of units and benches; None if errors use true directions.

        A bench error of None is that of each data set's standard bench.
        """
        if self.largest_deg is None and self.bench_deg is None:
            return None
        return self.bench_deg, self.confidence or CONFIDENCE

    @property
    def half_field_deg(self) -> float | None:
        """Half of the required field of view."""
        return None if self.min_fov_deg is None else self.min_fov_deg / 2

    def limit(self, name: str) -> float | None:
        """Return a numeric requirement by name."""
        value: float | None = getattr(self, name)
        return value

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that are set, in the order of `PARAMETERS`."""
        return tuple(name for name in PARAMETERS if self.value_of(name) is not None)

    def value_of(self, name: str) -> tuple[str, ...] | float | None:
        """Return the value of a parameter of `PARAMETERS`; None if it is not set."""
        if name in LIMITS:
            return self.limit(name)
        if name in LISTS or name == "exclude_needs":
            several: tuple[str, ...] = getattr(self, name)
            return several or None
        if name.startswith(EXCLUDE):
            return self.exclude.get(name.removeprefix(EXCLUDE)) or None
        return self.include.get(name) or None

    def without(self, *names: str) -> Requirements:
        """Return these requirements without some parameters."""
        changed: dict[str, object] = {
            name: () if name in LISTS or name == "exclude_needs" else None
            for name in names
            if name in LIMITS or name in LISTS or name == "exclude_needs"
        }
        for side, prefix in (("include", ""), ("exclude", EXCLUDE)):
            values = getattr(self, side)
            kept = {n: asked for n, asked in values.items() if prefix + n not in names}
            if len(kept) < len(values):
                changed[side] = MappingProxyType(kept)
        return replace(self, **changed) if changed else self  # type: ignore[arg-type]  # of fields

    def with_value(self, name: str, value: tuple[str, ...] | float | None) -> Requirements:
        """Return these requirements with one parameter replaced (dropped if None or empty)."""
        if name in LIMITS:
            return replace(self, **{name: value})  # type: ignore[arg-type]  # name is a limit's
        if name in LISTS or name == "exclude_needs":
            return replace(self, **{name: value or ()})  # type: ignore[arg-type]  # a list's
        side = "exclude" if name.startswith(EXCLUDE) else "include"
        values = dict(getattr(self, side))
        values.pop(name.removeprefix(EXCLUDE), None)
        if isinstance(value, tuple) and value:
            values[name.removeprefix(EXCLUDE)] = value
        kept = MappingProxyType(values)
        return replace(self, exclude=kept) if side == "exclude" else replace(self, include=kept)

    def to_dict(self) -> dict[str, object]:
        """Return the parameters that are set, as `parse` takes them."""
        asked: dict[str, tuple[str, ...] | float | None] = {
            **self.include,
            **{EXCLUDE + attribute: values for attribute, values in self.exclude.items()},
            **{name: getattr(self, name) for name in (*LIMITS, *LISTS, "exclude_needs")},
        }
        pairs = [(name, asked.get(name)) for name in PARAMETERS]
        pairs += [(name, getattr(self, name)) for name in SETTINGS]
        return {
            n: list(v) if isinstance(v, tuple) else v
            for n, v in pairs
            if v or (v == 0 and n in SETTINGS)
        }


def _texts(name: str, value: object) -> tuple[str, ...]:
    if isinstance(value, str):
        return (value,)
    if isinstance(value, Collection) and all(isinstance(item, str) for item in value):
        return tuple(dict.fromkeys(map(str, value)))
    raise InvalidValueError(name, value, "a value of the taxonomy or a list of them")


def _number(name: str, value: object) -> float:
    expected = LIMITS.get(name) or SETTINGS[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidValueError(name, value, expected)
    number = float(value)
    most = {"min_fov_deg": 360.0, "min_availability": 1.0, "confidence": 0.999}
    least = {"bench_deg": -1e-300, "confidence": 0.4999}.get(name, 0.0)
    if not math.isfinite(number) or number <= least or number > most.get(name, math.inf):
        raise InvalidValueError(name, value, expected)
    return number
