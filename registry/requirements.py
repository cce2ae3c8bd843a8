"""What is asked of a sun sensor: values to have or to avoid, and limits to keep."""

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
"""What a sensor may have to survive. Which conditions try it, `benchmark.datasets.hazards` says."""

LISTS = ("survive", "properties")
"""Requirements that all hold, several at once: hazards; properties of the survey's assessment."""

PARAMETERS = (*ATTRIBUTES, *(EXCLUDE + attribute for attribute in ATTRIBUTES), *LIMITS, *LISTS)
"""The names of all requirements, in the order in which they are reported."""

_KNOWN = frozenset(PARAMETERS)


@dataclass(frozen=True)
class Requirements:
    """Requirements on a sensor, its calibration, and the studies behind both.

    Several values of one attribute are alternatives; different attributes all hold. A parent
    value (ECM, ICM) stands for its kinds too. Detector, mask, model and extractor are the
    design's; task, error and accuracy are what its studies are about, address and reach, or what
    the survey advises it for. An excluded error or accuracy takes out the studies that have it,
    whatever else they have; an excluded task those that have no other.

    A sensor shall survive every hazard of ``survive``: answer often enough under it, within the
    largest error if one is asked for. An extractor shall have every one of ``properties`` in the
    survey's assessment, in part at least.
    """

    include: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    exclude: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    max_error_deg: float | None = None
    min_fov_deg: float | None = None  # full field of view
    min_availability: float | None = None
    max_latency_us: float | None = None
    survive: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()

    @classmethod
    def parse(
        cls, parameters: Mapping[str, object], taxonomy: Taxonomy, properties: Collection[str] = ()
    ) -> Self:
        """Return requirements from named parameters, checked.

        Parameters
        ----------
        parameters : mapping
            Names of `PARAMETERS`; a value or several for categories, a number for limits. None
            and empty collections ask nothing.
        taxonomy : Taxonomy
        properties : collection of str
            Those of the survey's assessment.

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
            if name in LIMITS:
                limits[name] = _number(name, value)
                continue
            values = _texts(name, value)
            if name in LISTS:
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
        for name in LIMITS:
            bound = self.limit(name)
            if bound is not None:
                _number(name, bound)
        for name, known in (("survive", HAZARDS), ("properties", properties)):
            for value in getattr(self, name):
                if value not in known:
                    raise unknown_name(name, value, known)

    @property
    def half_field_deg(self) -> float | None:
        """Half the field of view asked for."""
        return None if self.min_fov_deg is None else self.min_fov_deg / 2

    def limit(self, name: str) -> float | None:
        """Return a numeric requirement by name."""
        value: float | None = getattr(self, name)
        return value

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that ask something, in the order of `PARAMETERS`."""
        return tuple(name for name in PARAMETERS if self.asked(name) is not None)

    def asked(self, name: str) -> tuple[str, ...] | float | None:
        """Return what a parameter of `PARAMETERS` asks; None if nothing."""
        if name in LIMITS:
            return self.limit(name)
        if name in LISTS:
            several: tuple[str, ...] = getattr(self, name)
            return several or None
        if name.startswith(EXCLUDE):
            return self.exclude.get(name.removeprefix(EXCLUDE)) or None
        return self.include.get(name) or None

    def without(self, *names: str) -> Requirements:
        """Return these requirements less the parameters named."""
        changed = self
        for name in names:
            changed = changed.changed(name, None)
        return changed

    def changed(self, name: str, value: tuple[str, ...] | float | None) -> Requirements:
        """Return these requirements with one parameter replaced (dropped if None or empty)."""
        if name in LIMITS:
            return replace(self, **{name: value})  # type: ignore[arg-type]  # name is a limit's
        if name in LISTS:
            return replace(self, **{name: value or ()})  # type: ignore[arg-type]  # a list's
        side = "exclude" if name.startswith(EXCLUDE) else "include"
        values = dict(getattr(self, side))
        values.pop(name.removeprefix(EXCLUDE), None)
        if isinstance(value, tuple) and value:
            values[name.removeprefix(EXCLUDE)] = value
        kept = MappingProxyType(values)
        return replace(self, exclude=kept) if side == "exclude" else replace(self, include=kept)

    def to_dict(self) -> dict[str, object]:
        """Return the parameters that ask something, as they are passed in."""
        asked: dict[str, tuple[str, ...] | float | None] = {
            **self.include,
            **{EXCLUDE + attribute: values for attribute, values in self.exclude.items()},
            **{name: getattr(self, name) for name in (*LIMITS, *LISTS)},
        }
        told = ((name, asked.get(name)) for name in PARAMETERS)
        return {n: list(v) if isinstance(v, tuple) else v for n, v in told if v}


def _texts(name: str, value: object) -> tuple[str, ...]:
    if isinstance(value, str):
        return (value,)
    if isinstance(value, Collection) and all(isinstance(item, str) for item in value):
        return tuple(dict.fromkeys(map(str, value)))
    raise InvalidValueError(name, value, "a value of the taxonomy or a list of them")


def _number(name: str, value: object) -> float:
    expected = LIMITS[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidValueError(name, value, expected)
    number = float(value)
    most = {"min_fov_deg": 360.0, "min_availability": 1.0}.get(name, math.inf)
    if not math.isfinite(number) or number <= 0 or number > most:
        raise InvalidValueError(name, value, expected)
    return number
