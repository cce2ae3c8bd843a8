"""What a calibration file's columns mean: the settings that ``sensor.toml`` holds."""

from __future__ import annotations

import datetime as dt
import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    StrictBool,
    ValidationError,
    model_validator,
)

from algorithms.contract import SensorGeometry
from calibrate.forms.units import AngleUnit, TemperatureUnit, TimeUnit
from files.reading import parse_toml as toml_of
from files.reading import read_text

Kind = Literal["spot", "balance", "pair", "quadrants", "electrodes", "channels", "frames"]
#: Forms of two angles.
AngleForm = Literal[
    "projection", "alpha-inner", "beta-inner", "azimuth-elevation", "azimuth-zenith"
]
Form = Literal["vector", AngleForm, "one-angle", "quaternion", "matrix"]
#: Columns of readings that each kind has; None: any number from three up.
COLUMNS: dict[str, int | None] = {
    "spot": 2,
    "balance": 2,
    "pair": 2,
    "quadrants": 4,
    "electrodes": 4,
    "channels": None,
    "frames": 1,
}
#: Columns of the direction that each form has.
DIRECTION_COLUMNS: dict[str, int] = {"vector": 3, "one-angle": 1, "quaternion": 4, "matrix": 9}
#: A number that is written as one: no text, and no true or false, which Python counts as 1 and 0.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Count = Annotated[int, Strict()]
#: Largest size of a number of a reading, of a length in mm, and of a pixel's place.
_LARGEST, _LONGEST_MM, _FARTHEST_PX = 1e15, 1e4, 1e6
Reading = Annotated[Number, Field(ge=-_LARGEST, le=_LARGEST)]
Length = Annotated[Number, Field(gt=0, le=_LONGEST_MM)]
Place = Annotated[Number, Field(ge=-_FARTHEST_PX, le=_FARTHEST_PX)]
Index = Annotated[Number, Field(ge=1.0, le=5.0)]
Component = Annotated[Number, Field(ge=-1e6, le=1e6)]
#: Rows that readings may be late.
MOST_SHIFTED = 10_000
#: What a certificate says of what nobody stated, and of such a country.
UNSTATED, NO_COUNTRY = "not stated", "ZZ"
Transform = Literal[
    "swap-xy", "mirror-x", "mirror-y", "rotate-90", "rotate-180", "rotate-270", "swap-negated-xy"
]


class SettingsError(ValueError):
    """Settings that are not valid: what was expected and what came, one line a fault."""


def _no_number(stated: object) -> object:
    """Refuse a number for a date, which Pydantic would take for seconds since 1970."""
    if isinstance(stated, (int, float)):
        raise ValueError("expected a date, as 2026-11-26")  # noqa: TRY004 - Pydantic's
    return stated


Day = Annotated[dt.date, BeforeValidator(_no_number)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class FileSettings(_Strict):
    """How a file of text or a workbook is laid out, where it is not found by itself."""

    encoding: Annotated[str, Field(pattern="^[A-Za-z0-9_-]{1,30}$")] | None = Field(
        default=None, description="Of the text, as utf-8, utf-16 or cp1252."
    )
    separator: Literal[",", ";", "\t", "|", " "] | None = Field(
        default=None, description="Between cells; a blank stands for any number of blanks."
    )
    decimal: Literal[".", ","] | None = Field(default=None, description="Sign of decimals.")
    header_row: Annotated[Count, Field(ge=0, le=10_000)] | None = Field(
        default=None, description="Row of the names, the first row is 1; 0 where there is none."
    )
    sheet: Annotated[str, Field(max_length=100)] | None = Field(
        default=None, description="Of a workbook; by default the one with most numbers."
    )


class ReadingsSettings(_Strict):
    """Columns of the sensor's readings, and what they are."""

    kind: Kind = Field(
        description="spot: x and y of one spot; balance: two balances in [-1, 1]; quadrants: four "
        "voltages in the order (-x +y, +x +y, +x -y, -x -y); electrodes: x+, x-, y+, y-; channels: "
        "one reading a photodiode or solar cell; frames: one column with names of picture files. "
        "Of one axis: spot or balance with one column, or pair: two photodiodes."
    )
    columns: tuple[str, ...] = Field(description="Names of the columns, in that order.")
    dark: Reading | tuple[Reading, ...] = Field(
        default=0.0, description="Reading without light, subtracted; one for all or one a column."
    )
    gain: Reading | tuple[Reading, ...] = Field(
        default=1.0, description="Reading per unit of signal, divided out; positive."
    )
    inverted: StrictBool = Field(
        default=False,
        description="True where readings fall when light rises, or balances point back.",
    )

    extractor: str = Field(
        default="mirror", description="Of kind frames: the extractor that finds the spot in each."
    )

    @property
    def sign(self) -> float:
        """-1 where readings fall when light rises, 1 otherwise."""
        return -1.0 if self.inverted else 1.0

    @model_validator(mode="after")
    def _check(self) -> ReadingsSettings:
        count, wanted = len(self.columns), COLUMNS[self.kind]
        alone = self.kind in ("spot", "balance") and count == 1
        if wanted is not None and count != wanted and not alone:
            raise ValueError(
                f"kind {self.kind} has {wanted or 'three or more'} columns; got {count}"
            )
        if wanted is None and count < 3:
            raise ValueError(f"kind {self.kind} has three or more columns; got {count}")
        for name in ("dark", "gain"):
            value = getattr(self, name)
            if isinstance(value, tuple) and len(value) != count:
                raise ValueError(f"{name} must be one number or {count}; got {len(value)}")
        gains = self.gain if isinstance(self.gain, tuple) else (self.gain,)
        if not all(gain > 0 for gain in gains):
            raise ValueError("gain must be positive; say inverted = true for falling readings")
        return self


class DirectionSettings(_Strict):
    """Columns of the direction of the light, and how they say it."""

    columns: tuple[str, ...] = Field(description="Names of the columns, in the form's order.")
    form: Form = Field(
        description="vector: s_x, s_y, s_z towards the light; projection: alpha, beta with "
        "tan(alpha) = s_y/s_z, tan(beta) = s_x/s_z; alpha-inner: rotations of a turntable, the "
        "alpha axis next to the sensor; beta-inner: likewise; azimuth-elevation: azimuth from +x "
        "to +y, elevation above the detector's plane; azimuth-zenith: angle from the boresight; "
        "one-angle: of a sensor of one axis; quaternion, matrix (nine columns, row by row): the "
        "attitude, with the light's direction in light, light_columns or light_by_date."
    )
    unit: AngleUnit | tuple[AngleUnit, ...] = Field(
        default="deg", description="Of the angles: deg, rad, mrad, arcmin, arcsec or gon."
    )
    from_light: StrictBool = Field(
        default=False, description="True where vectors point from the light to the sensor."
    )
    scalar: Literal["first", "last"] = Field(
        default="last", description="Place of a quaternion's scalar among its columns."
    )
    attitude: Literal["to-sensor", "from-sensor"] = Field(
        default="to-sensor",
        description="Whether the attitude, as a rotation of vectors (v' = R v, v' = q v q*), turns "
        "the light's direction in the outer frame into that in the sensor's, or back.",
    )
    light: tuple[Component, Component, Component] = Field(
        default=(0.0, 0.0, 1.0),
        description="Direction of the light in the outer frame of an attitude, if it is fixed.",
    )
    light_columns: tuple[str, str, str] | None = Field(
        default=None, description="Columns of that direction, if it moves."
    )
    light_by_date: str | None = Field(
        default=None,
        description="Column of the date, if the light is the Sun and the outer frame is that of "
        "J2000: its apparent place from Earth is taken, light time and aberration included.",
    )

    @property
    def units(self) -> tuple[AngleUnit, ...]:
        """The unit of each column."""
        return self.unit if isinstance(self.unit, tuple) else (self.unit,) * len(self.columns)

    @model_validator(mode="after")
    def _check(self) -> DirectionSettings:
        wanted = DIRECTION_COLUMNS.get(self.form, 2)
        if len(self.columns) != wanted:
            raise ValueError(f"form {self.form} has {wanted} columns; got {len(self.columns)}")
        if len(self.units) != wanted:
            raise ValueError(f"unit must be one or {wanted}; got {len(self.units)}")
        if not any(self.light):
            raise ValueError("light must be a direction; got zeros")
        return self


class RowSettings(_Strict):
    """Columns that say more of a row."""

    run: str | None = Field(default=None, description="Column that tells runs apart.")
    time_s: str | None = Field(
        default=None, description="Column of the time; dates are read as seconds since 1970, UTC."
    )
    time_unit: TimeUnit = Field(
        default="s", description="Of the time: s, ms, us, ns, min, h, day, or jd, mjd."
    )
    temperature_K: str | None = Field(  # noqa: N815 - the unit's symbol
        default=None, description="Column of the temperature."
    )
    temperature_unit: TemperatureUnit = Field(
        default="K", description="Of that column: K, degC or degF."
    )
    shift: Annotated[Count, Field(ge=-MOST_SHIFTED, le=MOST_SHIFTED)] = Field(
        default=0, description="Rows by which the readings come after their poses."
    )


class BenchSettings(_Strict):
    """What is known of the bench."""

    floor_deg: Number = Field(
        default=0.0,
        ge=0.0,
        le=30.0,
        description="RMS error of the directions themselves.",
    )


class SensorSettings(_Strict):
    """The drawing, as far as it is known; see `algorithms.design.SensorGeometry`."""

    focal_length_mm: Length | None = None
    pixel_pitch_mm: Length | None = None
    centre_px: tuple[Place, Place] | None = None
    aperture_width_mm: Length | None = None
    aperture_shape: Literal["round", "square"] | None = None
    half_fov_deg: Annotated[Number, Field(gt=0, le=180)] | None = None
    face_normals: tuple[tuple[Component, Component, Component], ...] | None = None
    cover_glass: tuple[tuple[Length, Index], ...] | None = None
    mask_thickness_mm: Length | None = None

    @model_validator(mode="after")
    def _check(self) -> SensorSettings:
        for normal in self.face_normals or ():
            if not any(abs(part) > 1e-6 for part in normal):
                raise ValueError("face_normals must be directions; got one of zeros")
        return self

    def geometry(self) -> SensorGeometry:
        """Return the drawing as the models take it."""
        return SensorGeometry(**dict(self))


class CertificateSettings(_Strict):
    """Who calibrated what for whom, for `--certificate`."""

    laboratory: str = Field(default=UNSTATED, description="Who calibrated.")
    address: str = Field(default=UNSTATED, description="Of the laboratory.")
    country: Annotated[str, Field(pattern="^[A-Z]{2}$")] = Field(
        default=NO_COUNTRY,
        description="Of the laboratory, two letters of ISO 3166; ZZ where not stated.",
    )
    mail: str = Field(default=UNSTATED, description="E-mail address of the laboratory.")
    person: str = Field(default=UNSTATED, description="Who is responsible.")
    customer: str = Field(default=UNSTATED, description="For whom.")
    item: str = Field(default="sun sensor", description="What was calibrated.")
    manufacturer: str = Field(default=UNSTATED, description="Of it.")
    serial: str = Field(default=UNSTATED, description="Its serial number.")
    identifier: str | None = Field(
        default=None, description="Number of the certificate; by default the data's digest."
    )
    begin: Day | None = Field(
        default=None, description="First day of the measurement, as 2026-11-26; by default today."
    )
    end: Day | None = Field(default=None, description="Last day.")


class Settings(_Strict):
    """All that is said of a calibration file."""

    file: FileSettings = Field(
        default=FileSettings(), description="How the file is laid out; what is missing is found."
    )
    readings: ReadingsSettings = Field(description="What the sensor read.")
    direction: DirectionSettings = Field(description="Where the light was.")
    rows: RowSettings = Field(default=RowSettings(), description="What else is known of each row.")
    bench: BenchSettings = Field(default=BenchSettings(), description="The bench.")
    sensor: SensorSettings = Field(
        default=SensorSettings(),
        description="The drawing, as far as it is known; what is missing is estimated from the "
        "readings.",
    )
    certificate: CertificateSettings = Field(
        default=CertificateSettings(),
        description="Who calibrated what for whom, for --certificate.",
    )
    apply: tuple[Transform, ...] = Field(
        default=(),
        description="Changes of the readings' axes, in order, before anything is fitted.",
        max_length=20,
    )

    @model_validator(mode="after")
    def _check(self) -> Settings:
        alone = self.readings.kind == "pair" or (
            len(self.readings.columns) == 1 and self.readings.kind != "frames"
        )
        if alone and self.direction.form != "one-angle":
            raise ValueError(
                f"kind {self.readings.kind} with {len(self.readings.columns)} columns is of one "
                f'axis, with direction.form = "one-angle"; got {self.direction.form}'
            )
        return self


def parse_settings(stated: dict[str, Any], source: str) -> Settings:
    """Return settings of plain data; SettingsError naming every fault."""
    try:
        return Settings.model_validate(stated)
    except ValidationError as error:
        raise SettingsError(f"{source}: " + "\n".join(_faults(error))) from None


def _faults(error: ValidationError) -> list[str]:
    """Return a line a place: what was expected there, in all ways, and what came."""
    said: dict[str, list[str]] = {}
    came: dict[str, object] = {}
    for fault in error.errors():
        # a place that may hold one of several kinds is told once for each
        words = [
            str(part)[:60]
            for part in fault["loc"]
            if isinstance(part, int) or re.fullmatch(r"[A-Za-z_]\w*", part)
        ]
        place = ".".join(words[:3] if len(words) > 2 and words[2].isdigit() else words[:2])
        message = fault["msg"].removeprefix("Value error, ")
        said.setdefault(place or "settings", []).append(message)
        came[place or "settings"] = fault["input"]
    return [
        f"{place}: {' or '.join(dict.fromkeys(messages))}; got {_short(came[place])}"
        for place, messages in said.items()
        # of a list that may be one value too, the part that is wrong says more
        if not any(other.startswith(f"{place}.") for other in said)
    ]


def read_settings(path: Path) -> Settings:
    """Return the settings of a TOML file; SettingsError or FileRefusedError where it has none."""
    return parse_settings(parse_toml(read_text(path, 1_000_000), path.name), path.name)


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Return TOML text as plain data; SettingsError where it is none."""
    try:
        return toml_of(text)
    except RecursionError:
        raise SettingsError(f"{source}: brackets stand too deep in each other") from None
    except ValueError as error:  # numbers of thousands of digits, too
        raise SettingsError(f"{source}: {error}") from None


def _short(value: object) -> str:
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a number of thousands of digits, tables in each other
        text = f"a long {type(value).__name__}"
    return text if len(text) <= 60 else text[:57] + "..."
