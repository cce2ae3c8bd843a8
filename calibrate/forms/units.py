"""Units of columns: as names, brackets or a row of their own say them."""

from __future__ import annotations

import re
from typing import Literal, get_args

from pydantic import BaseModel, ConfigDict

AngleUnit = Literal["deg", "rad", "mrad", "arcmin", "arcsec", "gon"]
TemperatureUnit = Literal["K", "degC", "degF"]
TimeUnit = Literal["s", "ms", "us", "ns", "min", "h", "day", "jd", "mjd"]

#: Degrees in one unit of an angle.
DEGREES: dict[AngleUnit, float] = {
    "deg": 1.0,
    "rad": 57.29577951308232,
    "mrad": 0.05729577951308232,
    "arcmin": 1.0 / 60.0,
    "arcsec": 1.0 / 3600.0,
    "gon": 0.9,
}
#: Kelvin of a temperature ``t``: ``scale * t + offset``.
KELVIN: dict[TemperatureUnit, tuple[float, float]] = {
    "K": (1.0, 0.0),
    "degC": (1.0, 273.15),
    "degF": (5.0 / 9.0, 459.67 * 5.0 / 9.0),
}
#: Seconds of a time ``t``: ``scale * (t - zero)``; those of Julian days count from 1970.
SECONDS: dict[TimeUnit, tuple[float, float]] = {
    "s": (1.0, 0.0),
    "ms": (1e-3, 0.0),
    "us": (1e-6, 0.0),
    "ns": (1e-9, 0.0),
    "min": (60.0, 0.0),
    "h": (3600.0, 0.0),
    "day": (86400.0, 0.0),
    "jd": (86400.0, 2440587.5),
    "mjd": (86400.0, 40587.0),
}
#: Ways to write each unit, in lower case.
_SPELT: dict[str, tuple[str, ...]] = {
    "deg": ("deg", "degs", "degree", "degrees", "°", "º", "˚", "deg."),
    "rad": ("rad", "rads", "radian", "radians"),
    "mrad": ("mrad", "milliradian", "milliradians"),
    "arcmin": ("arcmin", "arcmins", "arcminute", "arcminutes", "amin", "'", "′"),
    "arcsec": ("arcsec", "arcsecs", "arcsecond", "arcseconds", "asec", '"', "″", "''"),
    "gon": ("gon", "gons", "gradian", "gradians", "grads"),
    "degC": ("degc", "deg_c", "deg c", "°c", "ºc", "˚c", "℃", "celsius", "c"),
    "K": ("k", "kelvin", "degk"),
    "degF": ("degf", "deg_f", "deg f", "°f", "fahrenheit", "f"),
    "s": ("s", "sec", "secs", "second", "seconds"),
    "ms": ("ms", "msec", "millis", "milliseconds"),
    "us": ("us", "µs", "μs", "usec", "microseconds"),
    "ns": ("ns", "nsec", "nanoseconds"),
    "min": ("min", "minute", "minutes"),
    "h": ("h", "hr", "hours"),
    "day": ("d", "day", "days"),
    "jd": ("jd", "julian"),
    "mjd": ("mjd",),
    "px": ("px", "pix", "pixel", "pixels"),
    "um": ("um", "µm", "μm", "micron", "microns"),
    "mm": ("mm",),
    "V": ("v", "volt", "volts"),
    "mV": ("mv",),
    "uV": ("uv", "µv", "μv"),
    "A": ("a", "amp", "ampere", "amperes"),
    "mA": ("ma",),
    "uA": ("ua", "µa", "μa"),
    "nA": ("na",),
    "counts": ("counts", "count", "cts", "adu", "dn", "lsb", "adc", "digits"),
    "lx": ("lx", "lux"),
    "W/m2": ("w/m2", "w/m^2", "w/m²"),
    "1": ("-", "1", "none", "a.u.", "au", "arb", "arb.", "n/a", "unitless", "dimensionless", "--"),
    "%": ("%", "percent"),
}
_UNIT_OF = {spelt: unit for unit, ways in _SPELT.items() for spelt in ways}
#: Units of one letter are taken off a name's end only where the rest names such a quantity.
_OF_LETTERS = {
    "degC": re.compile(r".*temp.*|t(emp)?"),
    "K": re.compile(r".*temp.*|t(emp)?"),
    "degF": re.compile(r".*temp.*"),
    "s": re.compile(r".*time.*|t"),
    "h": re.compile(r".*time.*|t"),
    "day": re.compile(r".*time.*|t"),
    "min": re.compile(r".*time.*|t"),
}
#: Letters of a name past which it says nothing.
_LONGEST = 100
_BRACKETS = re.compile(r"(?P<name>.+?)[\s_]*[\[({<]\s*(?P<unit>[^\])}>]*?)\s*[\])}>]")
_AFTER = re.compile(r"(?P<name>.+?)\s*(?:/|,|:|\s+in\s+)\s*(?P<unit>[^\s/,:]+)")
_ENDING = re.compile(r"(?P<name>.+?)[_\s.-]+(?P<unit>deg[_ ][cf]|[^_\s.-]+)", re.IGNORECASE)
_CAMEL = re.compile(r"(?P<name>.*[a-z])(?P<unit>Deg|Rad|Mrad|Arcmin|Arcsec|Px)")
_DEGREE_SIGN = re.compile(r"(?P<name>.+?)\s*(?P<unit>[°º˚])")


class Named(BaseModel):
    """A column's name without its unit."""

    model_config = ConfigDict(frozen=True)

    bare: str  # in lower case, words joined by ``_``
    unit: str | None  # as this module spells it

    @property
    def key(self) -> str:
        """The bare name, with ``_deg`` behind it where the unit is one of angles."""
        return f"{self.bare}_deg" if is_angle(self.unit) else self.bare


def unit_of(text: str) -> str | None:
    """Return the unit that a word or a sign says, as this module spells it; None if it is none."""
    word = text.strip().strip("[](){}<>").strip()
    return _UNIT_OF.get(word.lower())


def is_angle(unit: str | None) -> bool:
    """Say whether a unit is one of angles."""
    return unit in get_args(AngleUnit)


def named(name: str) -> Named:
    """Return a column's name and the unit that it says.

    Examples
    --------
    >>> named("Theta X [mrad]")
    Named(bare='theta_x', unit='mrad')
    >>> named("q_c")  # no temperature
    Named(bare='q_c', unit=None)
    """
    text = name.strip()
    if len(text) > _LONGEST:
        return Named(bare="", unit=None)
    for pattern in (_BRACKETS, _DEGREE_SIGN, _AFTER, _ENDING, _CAMEL):
        match = pattern.fullmatch(text)
        unit = unit_of(match["unit"]) if match else None
        if match is None or unit is None:
            continue
        bare = _bare(match["name"])
        if pattern in (_BRACKETS, _DEGREE_SIGN) or _goes_with(bare, match["unit"], unit):
            return Named(bare=bare, unit=unit)
    return Named(bare=_bare(text), unit=None)


def _goes_with(bare: str, spelt: str, unit: str) -> bool:
    """Say whether a unit at the end of a name is one: a letter or a number may be part of it."""
    if unit in _OF_LETTERS:
        return _OF_LETTERS[unit].fullmatch(bare) is not None
    return len(spelt) > 1 and unit != "1"


def _bare(name: str) -> str:
    joined = re.sub(r"(?<=\w)[\s.-]+(?=\w)", "_", name.strip())
    return re.sub(r"[\s_.]+$", "", joined).lower()
