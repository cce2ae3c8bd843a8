"""What a calibration file's columns mean: the settings that ``sensor.toml`` holds."""

from __future__ import annotations

import datetime as dt
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from algorithms.contract import SensorGeometry
from files.reading import read_text

Kind = Literal["spot", "balance", "quadrants", "electrodes", "channels", "frames"]
Form = Literal[
    "vector", "projection", "alpha-inner", "beta-inner", "azimuth-elevation", "azimuth-zenith"
]
#: Columns of readings that each kind has; None: any number from three up.
COLUMNS: dict[str, int | None] = {
    "spot": 2,
    "balance": 2,
    "quadrants": 4,
    "electrodes": 4,
    "channels": None,
    "frames": 1,
}
#: What a certificate says of what nobody stated, and of such a country.
UNSTATED, NO_COUNTRY = "not stated", "ZZ"
Transform = Literal[
    "swap-xy", "mirror-x", "mirror-y", "rotate-90", "rotate-180", "rotate-270", "swap-negated-xy"
]


class SettingsError(ValueError):
    """Settings that are not valid: what was expected and what came, one line a fault."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ReadingsSettings(_Strict):
    """Columns of the sensor's readings, and what they are."""

    kind: Kind = Field(
        description="spot: x and y of one spot; balance: two balances in [-1, 1]; quadrants: four "
        "voltages in the order (-x +y, +x +y, +x -y, -x -y); electrodes: x+, x-, y+, y-; channels: "
        "one reading a photodiode or solar cell; frames: one column with names of picture files."
    )
    columns: tuple[str, ...] = Field(description="Names of the columns, in that order.")
    dark: float | tuple[float, ...] = Field(
        default=0.0, description="Reading without light, subtracted; one for all or one a column."
    )
    gain: float | tuple[float, ...] = Field(
        default=1.0, description="Reading per unit of signal, divided out; positive."
    )
    inverted: bool = Field(
        default=False,
        description="True where readings fall when light rises, or balances point back.",
    )

    extractor: str = Field(
        default="mirror", description="Of kind frames: the extractor that finds the spot in each."
    )

    @model_validator(mode="after")
    def _check(self) -> ReadingsSettings:
        count, wanted = len(self.columns), COLUMNS[self.kind]
        if wanted is not None and count != wanted:
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

    columns: tuple[str, ...] = Field(description="Names of two or three columns.")
    form: Form = Field(
        description="vector: s_x, s_y, s_z towards the light; projection: alpha, beta with "
        "tan(alpha) = s_y/s_z, tan(beta) = s_x/s_z; alpha-inner: rotations of a turntable, the "
        "alpha axis next to the sensor; beta-inner: likewise; azimuth-elevation: azimuth from +x "
        "to +y, elevation above the detector's plane; azimuth-zenith: angle from the boresight."
    )
    unit: Literal["deg", "rad"] = Field(default="deg", description="Of the angles.")

    @model_validator(mode="after")
    def _check(self) -> DirectionSettings:
        wanted = 3 if self.form == "vector" else 2
        if len(self.columns) != wanted:
            raise ValueError(f"form {self.form} has {wanted} columns; got {len(self.columns)}")
        return self


class RowSettings(_Strict):
    """Columns that say more of a row."""

    run: str | None = Field(default=None, description="Column that tells runs apart.")
    time_s: str | None = Field(default=None, description="Column of the time, seconds.")
    temperature_K: str | None = Field(  # noqa: N815 - the unit's symbol
        default=None, description="Column of the temperature, kelvin."
    )
    shift: int = Field(default=0, description="Rows by which the readings come after their poses.")


class BenchSettings(_Strict):
    """What is known of the bench."""

    floor_deg: float = Field(
        default=0.0, ge=0.0, description="RMS error of the directions themselves."
    )


class SensorSettings(_Strict):
    """The drawing, as far as it is known; see `algorithms.design.SensorGeometry`."""

    focal_length_mm: Annotated[float, Field(gt=0)] | None = None
    pixel_pitch_mm: Annotated[float, Field(gt=0)] | None = None
    centre_px: tuple[float, float] | None = None
    aperture_width_mm: Annotated[float, Field(gt=0)] | None = None
    aperture_shape: Literal["round", "square"] | None = None
    half_fov_deg: Annotated[float, Field(gt=0, le=180)] | None = None
    face_normals: tuple[tuple[float, float, float], ...] | None = None
    cover_glass: tuple[tuple[float, float], ...] | None = None
    mask_thickness_mm: Annotated[float, Field(gt=0)] | None = None

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
    begin: dt.date | None = Field(
        default=None, description="First day of the measurement, as 2026-11-26; by default today."
    )
    end: dt.date | None = Field(default=None, description="Last day.")


class Settings(_Strict):
    """All that is said of a calibration file."""

    readings: ReadingsSettings
    direction: DirectionSettings
    rows: RowSettings = RowSettings()
    bench: BenchSettings = BenchSettings()
    sensor: SensorSettings = SensorSettings()
    certificate: CertificateSettings = CertificateSettings()
    apply: tuple[Transform, ...] = Field(
        default=(),
        description="Changes of the readings' axes, in order, before anything is fitted.",
    )


def parse_settings(stated: dict[str, Any], source: str) -> Settings:
    """Return settings of plain data; SettingsError naming every fault."""
    try:
        return Settings.model_validate(stated)
    except ValidationError as error:
        lines = [
            f"{'.'.join(str(part) for part in fault['loc']) or 'settings'}: "
            f"{fault['msg'].removeprefix('Value error, ')}; got {_short(fault['input'])}"
            for fault in error.errors()
        ]
        raise SettingsError(f"{source}: " + "\n".join(lines)) from None


def read_settings(path: Path) -> Settings:
    """Return the settings of a TOML file; SettingsError or FileRefusedError where it has none."""
    try:
        stated = tomllib.loads(read_text(path, 1_000_000))
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{path.name}: {error}") from None
    return parse_settings(stated, path.name)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
