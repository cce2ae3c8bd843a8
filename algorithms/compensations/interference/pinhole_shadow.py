"""The outline of a thick pinhole's spot, which each rim cuts with another limb (ICM/Shadow)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.nominal_projection import nominal_projection, require_projection
from algorithms.parameters import require_positive, require_within

ITERATIONS = 6
"""Fixed-point steps; each leaves a thousandth of what was left, for masks that are no tubes."""

FEWEST = 12
"""Samples that a calibration must have: ten numbers an axis are fitted beside the share."""

#: Of the shift's column, what is left of it beside the assembly's below which nothing is settled.
_SETTLED = 1e-3


@documented
@dataclass
class PinholeShadow(CalibratedCompensation):
    """Spots of a thick round hole corrected for shadowing of the outline by its rims.

    The lower rim limits the spot on its far side, the upper rim on its near side. For a single ray
    their mean is the middle of the mask, from which drawings measure the focal length. Because the
    Sun is a disc, its outer limb passes the lower rim last and its inner limb the upper rim, so the
    middle of the outline lies nearer to the boresight.

    Parameters
    ----------
    focal_length_mm : float
        Distance from the mask's middle to the detector, ``h + t / 2``, positive.
    thickness_mm : float
        Thickness t of the mask, positive, less than twice the focal length.
    aperture_mm : float
        Its hole's diameter d, positive.

    Attributes
    ----------
    share_ : float
        Of the shift that is subtracted, in [0, 1]: 1 for a method that finds the very outline, 0
        for one that weighs all light evenly.

    Notes
    -----
    Implements: eq:shadcomp (model:shad, Antonello2018) under the limbs of model:solar. With ``T+- =
    tan(theta +- rho)`` the outline goes from ``h T- + t max(T-, 0) - d / 2`` to ``h T+ + d / 2``;
    its middle falls short of ``(h + t / 2) (T+ + T-) / 2`` by ``t / 4 min(T+ + T-, T+ - T-)``. The
    survey's arcs have parallel light: then both rims' mean, ``(R_C0 + R_C1) / 2``, is the middle of
    the mask, and a focal length measured from there needs no correction. How much of the shift a
    method shows depends on the height at which it cuts the spot; that share is learnt (ours), by
    least squares beside offsets, turns and tilts of the head (third order in the tangents).
    `solar-disc` behind takes ``(T+ + T-) / 2`` to ``tan(theta)``.

    Shapes: features ``(x, y)`` (N, 2), in px, to the same.

    Failure: a NaN row for a NaN feature row, and where ``t tan(theta)`` reaches d and no light
    passes. fit raises UnusableDataError below 12 samples and where they do not tell the shift from
    a turned or shifted mask.

    Cost: 60 operations per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> tangents = sun[:, :2] / sun[:, 2:]
    >>> mask = PinholeShadow(1.0, unit_mm=1.0, thickness_mm=0.1, aperture_mm=0.2, disc_deg=2.0)
    >>> outlines = mask.spots(tangents, share=0.5)
    >>> round(mask.fit(outlines, sun).share_, 6)
    0.5
    >>> float(np.abs(mask.transform(outlines) - mask.spots(tangents, share=0.0)).max().round(9))
    0.0
    """

    about: ClassVar = AboutCompensation(
        name="pinhole-shadow",
        taxonomy="ICM/Shadow",
        studies=("Antonello2018",),
        labels=("model:shad", "eq:shadcomp", "model:solar"),
        origin="survey",
        needs=("focal_length_mm", "mask_thickness_mm", "aperture_width_mm", "aperture_shape"),
        accepts=frozenset({FeatureKind.SPOT}),
        ahead_of=("spm", "pinhole", "solar-disc + spm"),
    )

    focal_length_mm: float
    unit_mm: float
    thickness_mm: float
    aperture_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    disc_deg: float = 0.533

    share_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        by = self.about.name
        require_projection(by, self.focal_length_mm, self.unit_mm, self.centre)
        require_positive(by, thickness_mm=self.thickness_mm, aperture_mm=self.aperture_mm)
        if not self.thickness_mm < 2.0 * self.focal_length_mm:
            raise ValueError(
                f"{by}: thickness_mm must be less than twice focal_length_mm "
                f"{self.focal_length_mm!r}; got {self.thickness_mm!r}"
            )
        require_within(by, "(0, 10)", disc_deg=self.disc_deg)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the compensation of the sensor's pinhole.

        UnsuitableDesignError where the hole is not round, the mask has no thickness or plates lie
        under it.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        thickness = geometry.mask_thickness_mm or 0.0
        if geometry.aperture_shape != "round" or thickness == 0.0 or geometry.cover_glass:
            raise UnsuitableDesignError(
                f"{cls.about.name} needs one round hole in a mask that has a thickness, without "
                f"glass; got {geometry.aperture_shape}, {thickness:g} mm and cover glass "
                f"{geometry.cover_glass!r}"
            )
        return cls(
            **nominal_projection(geometry, kind, cls.about),
            thickness_mm=thickness,
            aperture_mm=geometry.aperture_width_mm or 0.0,
        )

    def spots(self, tangents: Floats, share: float) -> Floats:
        """Spots (N, 2) of the tangents (tan(beta), tan(alpha)) (N, 2) of the Sun's centre.

        Parameters
        ----------
        tangents : ndarray, shape (N, 2)
            Of the Sun's angles, along the detector's axes.
        share : float
            Of the shift that a method shows, as ``share_``.
        """
        radial = np.sqrt(tangents[:, 0] ** 2 + tangents[:, 1] ** 2)
        middle = self._limbs(radial)[0] * self.focal_length_mm
        stretch = np.full_like(radial, self.focal_length_mm)
        fallen = middle - share * self._shift(radial)
        np.divide(fallen, radial, out=stretch, where=radial > 0)
        return np.asarray(tangents * stretch[:, None] / self.unit_mm + np.asarray(self.centre))

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the share of the shift, beside what assembly moves."""
        del context
        by = self.about.name
        tangents = sun[:, :2] / sun[:, 2:]
        lit = self._lit(np.sqrt((tangents**2).sum(axis=1)))
        require_samples(int(lit.sum()), FEWEST, by, "a share beside the assembly")
        tangents, found = tangents[lit], features[lit]
        whole = self.spots(tangents, share=0.0)
        shifted = (self.spots(tangents, share=1.0) - whole).T.ravel()
        x, y = tangents.T
        powers = np.column_stack([x**i * y**j for i in range(4) for j in range(4 - i)])
        assembly = np.kron(np.eye(2), powers)
        design = np.column_stack([shifted, assembly])
        beside = shifted - assembly @ np.linalg.lstsq(assembly, shifted, rcond=None)[0]
        if not np.linalg.norm(beside) > _SETTLED * np.linalg.norm(shifted):
            raise UnusableDataError(
                f"{by}: the calibration samples do not tell the outline's shift from a turned or "
                "shifted mask; they must spread over the field of view"
            )
        solved = np.linalg.lstsq(design, (found - whole).T.ravel(), rcond=None)[0]
        self.share_ = float(np.clip(solved[0], 0.0, 1.0))

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Spots (N, 2) as both rims would cut them by rays from the limbs' mean."""
        del context
        moved = (features - np.asarray(self.centre)) * self.unit_mm
        fallen = np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2)
        shift, tangent, square = np.zeros_like(fallen), np.zeros_like(fallen), self._square
        for _ in range(ITERATIONS):
            mean = (fallen + shift) / self.focal_length_mm
            tangent = mean * (1.0 - square * tangent**2) / (1.0 + square)
            shift = self.share_ * self._shift(tangent)
        stretch = np.ones_like(fallen)
        np.divide(fallen + shift, fallen, out=stretch, where=fallen > 0)
        stretch[~self._lit(tangent)] = np.nan
        return np.asarray(moved * stretch[:, None] / self.unit_mm + np.asarray(self.centre))

    @property
    def _square(self) -> float:
        """Square of the tangent of the disc's radius."""
        return float(np.tan(np.radians(self.disc_deg / 2.0))) ** 2

    def _limbs(self, tangent: Floats) -> tuple[Floats, Floats]:
        """``(T+ + T-) / 2`` and ``(T+ - T-) / 2`` (N,) of the centre's tangent (N,)."""
        beneath = 1.0 - self._square * tangent**2
        mean = tangent * (1.0 + self._square) / beneath
        return mean, np.sqrt(self._square) * (1.0 + tangent**2) / beneath

    def _shift(self, tangent: Floats) -> Floats:
        """Millimetres (N,) by which the outline's middle falls short."""
        mean, half = self._limbs(tangent)
        return np.asarray(self.thickness_mm / 2.0 * np.minimum(mean, half))

    def _lit(self, tangent: Floats) -> NDArray[np.bool_]:
        return np.asarray(self.thickness_mm * tangent < self.aperture_mm)
