"""`SlitModel`: lines of pixels behind slits; the drawing, and which shifts make a spot.

Extractors of profiles find one shift for each line and slant, in px along the line, and give the
spot (x, y) that the drawing's slits make of them: ``shift = D_u + D_v tan(slant)``. With two shifts
nothing is lost on the way, so a model casts the shifts of the sensor as it was built and turns
them into a spot as the drawing has it. Each slit's own place, and each edge's, are not among the
features; slits of one line and slant come as their mean.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np

from algorithms.calibration.forward import ForwardModel, circle
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.models.nominal_projection import require_projection

LineAxis = Literal["x", "y"]
Slit = tuple[float, float, float]
Plate = tuple[float, float]

#: Slants of two crossed slits, degrees, to within this.
_DIAGONAL_DEG, _SAME_DEG = 45.0, 1e-6

#: What every model of lines behind slits needs of a sensor's design.
NEEDS = ("focal_length_mm", "pixel_pitch_mm", "centre_px", "line_axes", "slits")


@dataclass
class SlitModel(ForwardModel):
    """A model of lines of pixels behind slits, which casts the shifts of their spots.

    A subclass writes `free_parameters`, `require_slits` and `shifts`.

    Parameters
    ----------
    focal_length_mm : float
        Nominal distance from the slits' middle to the lines, positive.
    pixel_pitch_mm : float
        Distance between pixels, positive.
    centre_px : tuple of two float
        Spot (x, y) when the Sun is on the boresight.
    line_axes : tuple of {"x", "y"}
        The detector axis along which each line lies.
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit, the same over all lines.
    cover_glass : tuple of (float, float)
        Thickness mm and index of each plate between slits and lines; none leaves refraction out.
    """

    about: ClassVar[AboutModel]

    focal_length_mm: float
    pixel_pitch_mm: float
    centre_px: tuple[float, float]
    line_axes: tuple[LineAxis, ...]
    slits: tuple[Slit, ...]
    cover_glass: tuple[Plate, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        by = self.about.name
        require_projection(by, self.focal_length_mm, self.pixel_pitch_mm, self.centre_px)
        for thickness, index in self.cover_glass:
            if not (thickness > 0 and index >= 1):
                raise ValueError(
                    f"{by}: cover_glass must be plates of positive thickness and an index of at "
                    f"least 1; got {self.cover_glass!r}"
                )
        if sum(plate[0] for plate in self.cover_glass) > self.focal_length_mm:
            raise ValueError(
                f"{by}: cover_glass must fit under a mask at {self.focal_length_mm} mm; got "
                f"{self.cover_glass!r}"
            )
        layout = self.layout()
        if len(layout) != 2 or abs(np.linalg.det(layout)) < 1e-9:
            raise UnsuitableDesignError(
                f"{by} needs lines along x and y behind slits of one slant, or one line behind "
                f"slits of two; got lines {self.line_axes!r} and slits {self.slits!r}"
            )
        self.require_slits()

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing.

        UnsuitableDesignError where the lines and slits are not of its architecture.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        design = {name: getattr(geometry, name) for name in cls.about.needs}
        return cls(**design, cover_glass=geometry.cover_glass or ())

    @abstractmethod
    def require_slits(self) -> None:
        """Raise UnsuitableDesignError unless the slits are of this model's architecture."""
        ...

    @abstractmethod
    def shifts(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) shifts of spots, mm, of tangents (N, 2) as the head sees the Sun."""
        ...

    def slants(self) -> tuple[float, ...]:
        """Different slants, degrees, in the order of the slits."""
        return tuple(dict.fromkeys(slit[1] for slit in self.slits))

    def layout(self) -> Floats:
        """Rows, one a line and slant: what its shift is of the displacement (D_x, D_y)."""
        tangents = [math.tan(math.radians(slant)) for slant in self.slants()]
        return np.array(
            [
                (1.0, tangent) if axis == "x" else (tangent, 1.0)
                for axis in self.line_axes
                for tangent in tangents
            ]
        )

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) spots in px of tangents (N, 2), as the drawing makes them of the shifts."""
        first, second = self.shifts(vector, tangents).T
        (a, b), (c, d) = self.layout().tolist()
        scale = 1.0 / (self.pixel_pitch_mm * (a * d - b * c))
        x, y = self.centre_px
        spots = np.empty((len(tangents), 2))
        np.add(x, (scale * d) * first - (scale * b) * second, out=spots[:, 0])
        np.add(y, (scale * a) * second - (scale * c) * first, out=spots[:, 1])
        return spots

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent of a pixel, and the spot on the boresight."""
        return self.pixel_pitch_mm / self.focal_length_mm, self.centre_px

    def glass(self, tangents: Floats) -> Floats:
        """(N,) mm by which the drawing's plates shorten the focal length.

        See `refraction_height_mm`.
        """
        total = np.zeros(len(tangents))
        for thickness, index in self.cover_glass:
            total += refraction_height_mm(tangents, thickness, index)
        return total


def refraction_height_mm(tangents: Floats, thickness_mm: float, index: float) -> Floats:
    """Height (N,), mm, of air that would displace a ray as much less as a plate does.

    Snell's law (eq:refcomp1): a plate displaces by ``t sin(theta) / sqrt(n^2 - sin^2(theta))``,
    air as thick by ``t tan(theta)``.

    Examples
    --------
    >>> refraction_height_mm(np.array([[0.0, 0.0]]), 0.5, 1.25).round(6)  # t (1 - 1 / n)
    array([0.1])
    """
    square = tangents[:, 0] ** 2 + tangents[:, 1] ** 2
    with np.errstate(invalid="ignore"):
        return np.asarray(
            thickness_mm * (1.0 - 1.0 / np.sqrt(index**2 + (index**2 - 1.0) * square))
        )


def shadow(
    tangents: Floats,
    slit: tuple[float, float],
    height_mm: Floats,
    line: tuple[float, float, float, float],
) -> Floats:
    """Shift (N,), mm, of the spots of slits over one line of pixels that stands as it was built.

    Parameters
    ----------
    tangents : ndarray, shape (N, 2)
        Along the line and across it, as the mask sees the Sun.
    slit : tuple of two float
        Position mm (of several, their mean) and tangent of the slant.
    height_mm : ndarray, shape (N,)
        Of the mask over the line's middle, less what glass takes off it.
    line : tuple of four float
        Where the mask's middle is off the line's along and across it, mm; the line's turn in the
        mask's plane and out of it, towards the mask, degrees.

    Notes
    -----
    In the mask's frame the line's points are ``(-along + X c_u, -across + X c_v, -h + X c_n)``, a
    ray through one meets the mask at ``(u, v) - height t``, and a slit is ``u + v tan(slant) =
    position``: one linear equation for X.
    """
    along, across, turn, rise = line
    (c, s), (cos_rise, c_n) = circle(turn), circle(rise)
    position, slant = slit
    reach = tangents[:, 0] + slant * tangents[:, 1]
    place = height_mm * reach + (position + along + slant * across)
    return np.asarray(place / ((c + slant * s) * cos_rise + c_n * reach) - position)


def require_crossed_slits(geometry: SensorGeometry, by: str) -> None:
    """Raise UnsuitableDesignError unless there are two slits of one width, 45 deg to the axes."""
    slits = geometry.slits or ()
    slants = sorted(slant for _, slant, _ in slits)
    crossed = len(slants) == 2 and np.allclose(
        slants, (-_DIAGONAL_DEG, _DIAGONAL_DEG), rtol=0.0, atol=_SAME_DEG
    )
    if not (crossed and slits[0][2] == slits[1][2]):
        raise UnsuitableDesignError(
            f"{by} needs two slits of one width, 45 deg to either side of the axes; got {slits!r}"
        )
