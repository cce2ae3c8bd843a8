"""Requirements on a sun sensor: values to include or exclude, limits, settings, missions."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, Self

from registry.taxonomy import ATTRIBUTES, InvalidValueError, Taxonomy, unknown_name
from survey_data.processors import is_processor, processors

EXCLUDE = "exclude_"

LIMITS: Mapping[str, str] = MappingProxyType(
    {
        "max_error_deg": "a positive number of degrees",
        "min_fov_deg": "a number of degrees above 0, at most 360",
        "min_availability": "a share above 0, at most 1",
        "max_latency_us": "a positive number of microseconds",
        "max_mass_g": "a positive number of grams",
        "max_power_mw": "a positive number of milliwatts",
        "min_rate_hz": "a positive number of updates a second",
    }
)
"""Numeric requirements and their allowed values. ``min_fov_deg`` is the full field of view."""

OF_PRODUCTS = ("max_mass_g", "max_power_mw", "min_rate_hz")
"""Limits that only built sensors have numbers for: an unknown number does not exclude."""

OF_STUDIES = ("task", "error")
"""Requirements on the studies of an architecture, or on the survey's advice for it."""

EVIDENCE = ("any", "reported", "measured", "both")
Evidence = Literal["any", "reported", "measured", "both"]

LEVELS = ("flight", "own")
Level = Literal["flight", "own"]
"""Errors that limits are judged by: of a sensor that was calibrated on the ground once and flown,
or its own, of true directions in the calibration and nothing that changed since."""

SETTINGS: Mapping[str, str] = MappingProxyType(
    {
        "bench_deg": "a number of degrees, 0 or more",
        "confidence": "a share from 0.5 to 0.999",
        "sun_distance_au": "a number of astronomical units from 0.05 to 100",
        "processor": "a processor's name, or a positive number",
        "evidence": f"one of {', '.join(EVIDENCE)}",
        "level": f"one of {', '.join(LEVELS)}",
    }
)
"""How requirements are judged: error of the calibration bench (none stated: the answer says which
bench it takes), share of units and benches that must meet a limit, distance from the Sun, time
relative to the machine of the published times, which evidence must meet all requirements, and which
level of error is judged (`LEVELS`, the first by default)."""

CONFIDENCE = 0.9
"""Default share of units and benches that must meet a limit."""

UNITS = 10
"""Number of sensor units over which a pipeline is judged."""

CLASSES_DEG: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "CSS": (0.5, math.inf),
        "FSS": (1 / 60, 0.5),
        "VFSS": (10 / 3600, 1 / 60),
        "UFSS": (0.0, 10 / 3600),
    }
)
"""Accuracy classes of the survey: smallest error (included) and largest (not included)."""

HAZARDS: Mapping[str, str] = MappingProxyType(
    {
        "albedo": "sunlight from the Earth, with clouds where they are drawn",
        "missing-apertures": "apertures that are closed, by dirt or in making",
        "ageing": "a detector at the end of its life, dead pixels",
        "temperature": "hot and cold",
        "misalignment": "turned in its mount and shifted against its mask",
        "glare": "glare, ghosts, stray light and gradients of it",
        "saturation": "an over-exposed detector",
        "spin": "turning during the exposure",
        "noise": "ten times the noise",
    }
)
"""Hazards that a sensor may have to tolerate; `benchmark.datasets.hazards` lists the conditions."""

LISTS = ("tolerate", "properties")
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

_SEVERAL = (*LISTS, "exclude_needs")

PARAMETERS = (
    *(*ATTRIBUTES, *(EXCLUDE + attribute for attribute in ATTRIBUTES), *LIMITS, *_SEVERAL),
)
"""Names of all requirements, in reporting order."""

MISSIONS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "leo-cubesat": {
            "max_error_deg": 0.5,
            "min_fov_deg": 100.0,
            "max_mass_g": 50.0,
            "max_power_mw": 200.0,
            "tolerate": ("albedo",),
        },
        "deep-space": {
            "max_error_deg": 0.1,
            "sun_distance_au": 3.0,
            "exclude_needs": ("nadir", "magnetic-field", "eclipse"),
        },
        "lunar-surface": {
            "max_error_deg": 0.1,
            "min_fov_deg": 100.0,
            "tolerate": ("temperature",),
            "exclude_needs": ("nadir", "magnetic-field"),
        },
        "spinner": {"max_error_deg": 0.5, "min_rate_hz": 5.0, "exclude_needs": ("rates",)},
        "ground-tracker": {
            "max_error_deg": 0.05,
            "min_fov_deg": 60.0,
            "exclude_needs": ("rates", "nadir", "magnetic-field", "eclipse"),
        },
    }
)
"""Named sets of requirements to begin with; a requirement stated beside one replaces its own."""

#: Light at 1 au over which, and under the inverse of which, another condition is nearer: it is half
#: way (in ratio) to ten times the light or a tenth of it.
_NEAR_LIGHT = math.sqrt(10.0)


@dataclass(frozen=True)
class Light:
    """Sunlight at a distance: ``flux`` relative to 1 au, and the hazard whose condition is nearest.

    ``hazard`` is empty where the nominal condition is the nearest.
    """

    distance_au: float
    flux: float
    hazard: str

    @property
    def words(self) -> str:
        """What the distance is judged by."""
        light = f"{self.distance_au:g} au: {self.flux:.2g} times the light of 1 au"
        if not self.hazard:
            return f"{light}; judged under the nominal condition, the nearest simulated"
        return (
            f"{light}; judged under `{self.hazard}` ({HAZARDS[self.hazard]}), the nearest simulated"
        )


def light_at(distance_au: float) -> Light:
    """Return the light at a distance from the Sun, and which hazard it is judged by."""
    flux = distance_au**-2
    hazard = "saturation" if flux > _NEAR_LIGHT else "noise" if flux < 1 / _NEAR_LIGHT else ""
    return Light(distance_au, flux, hazard)


@dataclass(frozen=True)
class Requirements:
    """Requirements on a sensor, its calibration, and the studies behind both.

    Several values of one attribute are alternatives; different attributes must all be met. A
    parent value (ECM, ICM) includes its kinds. Detector, mask, model and extractor are parts of a
    design; task and error are attributes of its studies, or of the survey's advice; accuracy is a
    class. An excluded error or accuracy removes every study that has it; an excluded task removes
    the studies that have no other task.

    Under every hazard of ``tolerate`` the availability must be high enough, and the error within
    the largest error if there is one. An extractor must have all ``properties`` in the survey's
    assessment, at least partly.
    """

    include: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    exclude: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    max_error_deg: float | None = None
    min_fov_deg: float | None = None  # full field of view
    min_availability: float | None = None
    max_latency_us: float | None = None
    max_mass_g: float | None = None
    max_power_mw: float | None = None
    min_rate_hz: float | None = None
    tolerate: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    exclude_needs: tuple[str, ...] = ()
    bench_deg: float | None = None
    confidence: float | None = None
    sun_distance_au: float | None = None
    processor: str | float | None = None
    evidence: Evidence | None = None
    level: Level | None = None
    mission: str | None = None

    @classmethod
    def parse(
        cls, parameters: Mapping[str, object], taxonomy: Taxonomy, properties: Collection[str] = ()
    ) -> Self:
        """Make requirements from named parameters, and check them.

        Parameters are `PARAMETERS`, `SETTINGS`, and ``mission``; one or several values for
        categories, a number for limits. None and empty collections are no requirement. `properties`
        are those of the survey's assessment.

        Raises
        ------
        InvalidValueError
            For an unknown parameter or value, naming the nearest, or an impossible limit.
        """
        given = {name: value for name, value in parameters.items() if value not in (None, (), [])}
        mission = given.pop("mission", None)
        if mission is not None:
            if mission not in MISSIONS:
                raise unknown_name("mission", mission, MISSIONS)
            given = {**MISSIONS[str(mission)], **given}
        sides: dict[str, dict[str, tuple[str, ...]]] = {"include": {}, "exclude": {}}
        others: dict[str, Any] = {}
        for name, value in given.items():
            if name in LIMITS or name in SETTINGS:
                others[name] = value
            elif name in _SEVERAL:
                others[name] = _texts(name, value)
            elif name in PARAMETERS:
                side = "exclude" if name.startswith(EXCLUDE) else "include"
                sides[side][name.removeprefix(EXCLUDE)] = _texts(name, value)
            else:
                raise unknown_name("parameter", name, (*PARAMETERS, *SETTINGS, "mission"))
        include, exclude = (MappingProxyType(sides[side]) for side in ("include", "exclude"))
        named = None if mission is None else str(mission)
        requirements = cls(include, exclude, **others, mission=named)
        requirements.check(taxonomy, properties)
        return requirements

    def check(self, taxonomy: Taxonomy, properties: Collection[str] = ()) -> None:
        """Raise InvalidValueError unless every attribute, value and limit is possible."""
        for prefix, asked in (("", self.include), (EXCLUDE, self.exclude)):
            for attribute, values in asked.items():
                _require_values(taxonomy, prefix, attribute, values)
        for name in (*LIMITS, *_RANGES):
            if getattr(self, name) is not None:
                _require_number(name, getattr(self, name))
        named: tuple[tuple[str, Collection[str]], ...] = (
            *(("tolerate", HAZARDS), ("properties", properties), ("exclude_needs", NEEDS)),
            *(("evidence", EVIDENCE), ("level", LEVELS)),
        )
        for name, known in named:
            stated = getattr(self, name) or ()
            for value in (stated,) if isinstance(stated, str) else stated:
                if value not in known:
                    raise unknown_name(name, value, known)
        if not is_processor(self.processor):
            raise unknown_name("processor", self.processor, processors())

    @property
    def largest_deg(self) -> float | None:
        """Largest allowed error: the number, or that of the coarsest required accuracy class."""
        classes = [CLASSES_DEG[value][1] for value in self.include.get("accuracy", ())]
        limits = [x for x in (self.max_error_deg, max(classes, default=None)) if x is not None]
        least = min(limits, default=math.inf)
        return least if math.isfinite(least) else None

    @property
    def judged_level(self) -> Level:
        """Level of error that is judged."""
        return self.level or "flight"

    @property
    def share(self) -> float:
        """Share of units and benches that must meet a limit."""
        return self.confidence or CONFIDENCE

    @property
    def light(self) -> Light | None:
        """Light at the distance asked for; None where none is."""
        return None if self.sun_distance_au is None else light_at(self.sun_distance_au)

    @property
    def hazards(self) -> tuple[str, ...]:
        """Hazards to tolerate, with the one that the distance from the Sun is judged by."""
        of_light = self.light.hazard if self.light else ""
        return tuple(dict.fromkeys((*self.tolerate, *filter(None, (of_light,)))))

    @property
    def half_field_deg(self) -> float | None:
        """Half of the required field of view."""
        return None if self.min_fov_deg is None else self.min_fov_deg / 2

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the requirements that are set, in the order of `PARAMETERS`."""
        found = tuple(name for name in PARAMETERS if name in self._values)
        return (*found, "sun_distance_au") if self.sun_distance_au is not None else found

    def value_of(self, name: str) -> Any:
        """Return the value of a requirement, texts or a number; None if it is not set."""
        return self._values.get(name)

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        """Values of all requirements and settings that are set."""
        found: dict[str, Any] = {
            name: getattr(self, name) for name in (*LIMITS, *_SEVERAL, *SETTINGS, "mission")
        }
        found |= {EXCLUDE + name: values for name, values in self.exclude.items()}
        found |= self.include
        return {name: value for name, value in found.items() if value not in (None, ())}

    def without(self, *names: str) -> Requirements:
        """Return these requirements without some parameters."""
        found = self
        for name in names:
            found = found.with_value(name, None)
        return found

    def with_value(self, name: str, value: tuple[str, ...] | float | None) -> Requirements:
        """Return these requirements with one parameter replaced (dropped if None or empty)."""
        if name in _SEVERAL:
            return replace(self, **{name: value or ()})  # type: ignore[arg-type]  # a list's
        if name in self.__dataclass_fields__:
            return replace(self, **{name: value})  # type: ignore[arg-type]  # a number's
        side = "exclude" if name.startswith(EXCLUDE) else "include"
        values = {**getattr(self, side), name.removeprefix(EXCLUDE): value}
        kept = MappingProxyType({n: asked for n, asked in values.items() if asked})
        return replace(self, **{side: kept})  # type: ignore[arg-type]  # one of the two

    def to_dict(self) -> dict[str, Any]:
        """Return the parameters that are set, as `parse` takes them."""
        pairs = [(name, self.value_of(name)) for name in (*PARAMETERS, *SETTINGS, "mission")]
        return {n: list(v) if isinstance(v, tuple) else v for n, v in pairs if v is not None}


def _texts(name: str, value: object) -> tuple[str, ...]:
    if isinstance(value, str):
        return (value,)
    if isinstance(value, Collection) and all(isinstance(item, str) for item in value):
        return tuple(dict.fromkeys(map(str, value)))
    raise InvalidValueError(name, value, "a value of the taxonomy or a list of them")


def _require_values(
    taxonomy: Taxonomy, prefix: str, attribute: str, values: Collection[str]
) -> None:
    if attribute not in ATTRIBUTES:
        raise unknown_name("attribute", attribute, ATTRIBUTES)
    for value in values:
        taxonomy.require(attribute, value, parameter=prefix + attribute)


#: Least and largest allowed values where they are not just above 0.
_RANGES: Mapping[str, tuple[float, float]] = {
    "bench_deg": (0.0, math.inf),
    "confidence": (0.5, 0.999),
    "sun_distance_au": (0.05, 100.0),
}
_MOST = {"min_fov_deg": 360.0, "min_availability": 1.0}


def _require_number(name: str, value: object) -> None:
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        least, most = _RANGES.get(name, (math.ulp(0.0), _MOST.get(name, math.inf)))
        if least <= value <= most:
            return
    raise InvalidValueError(name, value, LIMITS.get(name) or SETTINGS[name])
