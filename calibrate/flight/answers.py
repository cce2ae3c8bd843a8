"""What an answer says beside the direction: two angles in the file's form, and a 1-sigma."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from algorithms.contract import Floats
from calibrate.calibration import Calibration
from calibrate.places import Grazing
from calibrate.uncertainty import Intervals


@dataclass(frozen=True)
class AngleForm:
    """Two angles of a direction, in words and as expressions of x, y and z, radians."""

    words: str
    c: tuple[str, str]
    python: tuple[str, str]


def _form(words: str, first: str, second: str) -> AngleForm:
    """Return a form whose expressions have ``atan2`` and ``root`` for both languages."""

    def of(atan2: str, root: str) -> tuple[str, str]:
        one, two = (text.replace("atan2", atan2).replace("root", root) for text in (first, second))
        return one, two

    return AngleForm(words, of("ATAN2", "SQRT"), of("np.arctan2", "np.sqrt"))


_POLAR = _form(
    "azimuth from +x to +y and angle off the boresight",
    "atan2(y, x)",
    "atan2(root((x * x) + (y * y)), z)",
)
#: By the form of the file's directions; vectors, and forms not named here, get azimuth and angle
#: off the boresight.
_FORMS = {
    "projection": _form(
        "alpha = atan(s_y / s_z) and beta = atan(s_x / s_z)", "atan2(y, z)", "atan2(x, z)"
    ),
    "alpha-inner": _form(
        "rotations alpha = asin(s_y) and beta = atan2(s_x, s_z)",
        "atan2(y, root((x * x) + (z * z)))",
        "atan2(x, z)",
    ),
    "beta-inner": _form(
        "rotations alpha = atan2(s_y, s_z) and beta = asin(s_x)",
        "atan2(y, z)",
        "atan2(x, root((y * y) + (z * z)))",
    ),
    "azimuth-elevation": _form(
        "azimuth from +x to +y and elevation above the detector's plane",
        "atan2(y, x)",
        "atan2(z, root((x * x) + (y * y)))",
    ),
    "azimuth-zenith": _POLAR,
}


@dataclass(frozen=True)
class Answers:
    """Form of the angles, and the 1-sigma by place.

    `rings_deg` (K,) are off-axis angles of ring centres about `axis` (3,); sector m of M is at the
    azimuth 360 m / M about it, from +x towards +y. `sigma_deg` (K, M, 2) is of the two axes of
    `calibrate.places.tangent_axes` and grows by `grazing` where light grazes a face.
    `rotation` (3, 3) takes directions and their 1-sigma to those answered.
    """

    form: AngleForm
    axis: Floats
    rings_deg: Floats
    sectors: int
    sigma_deg: Floats
    grazing: Grazing = field(default_factory=Grazing.none)
    rotation: Floats = field(default_factory=lambda: np.eye(3))

    @property
    def bytes(self) -> int:
        """Size of the constants in double precision."""
        return 8 * sum(np.size(value) for value in self.constants().values())

    @property
    def grazes(self) -> bool:
        """Whether the 1-sigma grows where light grazes a face."""
        return len(self.grazing.normals) > 0

    @property
    def turns(self) -> bool:
        """Whether answers are turned."""
        return not np.array_equal(self.rotation, np.eye(3))

    @property
    def operations(self) -> int:
        """Most operations of what widens the 1-sigma at grazing light and turns answers."""
        grazing = 45 + 29 * len(self.grazing.normals) if self.grazes else 0
        return grazing + (170 if self.turns else 0)

    @property
    def calls(self) -> int:
        """Most calls of the mathematics library that this takes."""
        return 4 * self.grazes + 6 * self.turns

    def constants(self) -> dict[str, Any]:
        """Return all constants of an answer but its turn."""
        return {**self.places(), **(self.faces() if self.grazes else {"FACES": 0})}

    def places(self) -> dict[str, Any]:
        """Return what C and Python read: the axes about which places are counted, and the table."""
        start = np.array([1.0, 0.0, 0.0] if abs(self.axis[0]) < 0.9 else [0.0, 1.0, 0.0])
        first = start - (start @ self.axis) * self.axis
        first /= np.linalg.norm(first)
        return {
            "rings": np.asarray(self.rings_deg, dtype=np.float64),
            "basis": np.stack([first, np.cross(self.axis, first), self.axis]),
            "table": np.asarray(self.sigma_deg, dtype=np.float64),
            "RINGS": len(self.rings_deg),
            "SECTORS": int(self.sectors),
        }

    def faces(self) -> dict[str, Any]:
        """Return what C and Python read of faces that light grazes."""
        known = self.grazing
        return {
            "normals": known.normals,
            "sine": float(known.sine),
            "grown": float(known.grown),
            "FACES": len(known.normals),
        }


def answers_of(found: Calibration) -> Answers:
    """Return the form and the 1-sigma of a calibration; one number where it knows no places."""
    constant = np.nan if found.intervals is not None else _constant_deg(found)
    return answers_at(found.settings.direction.form, found.intervals, constant)


def answers_at(form: str, known: Intervals | None, constant_deg: float) -> Answers:
    """Return the form of angles and the 1-sigma by place, or everywhere one number."""
    angles = _FORMS.get(form, _POLAR)
    if known is not None:
        return Answers(
            angles, known.axis, known.rings_deg, known.sectors, known.sigma_deg, known.grazing
        )
    sigma = np.full((2, 1, 2), constant_deg)
    return Answers(angles, np.array([0.0, 0.0, 1.0]), np.array([0.0, 180.0]), 1, sigma)


def _constant_deg(found: Calibration) -> float:
    """Return the root mean square of what the calibration states, of one tangent axis."""
    used = found.readings.thinned(2000)
    stated = found.deviation_deg(used.features, dict(used.context))
    stated = stated[np.isfinite(stated)]
    if not len(stated):
        return float(found.chosen.rms_deg / np.sqrt(2.0))
    return float(np.sqrt(np.mean(stated**2)))
