"""Sun vectors from many cells all around: weighted least squares over the lit ones (Panoramic)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.faces_model import FacesModel
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.geometric.detector_faces import Normals, directions, require_normals
from algorithms.parameters import require_choice, require_within
from algorithms.row_arithmetic import normalise

Weighting = Literal["signal", "equal"]

FEWEST_LIT = 3
"""A direction and the light's strength are three unknowns."""

FLATTEST = 1e-6
"""Smallest determinant of the normal matrix, over its trace cubed, that settles a direction."""


@documented
@dataclass
class WeightedCells(FacesModel):
    """Sun vector by weighted least squares over the cosines of all lit cells.

    Several cells on a sphere are always lit. Each is weighted by its illumination, and cells at
    grazing incidence are excluded.

    Parameters
    ----------
    weighting : {"signal", "equal"}
        Weight of a lit cell: its signal over its reference current, or 1.
    largest_incidence_deg : float
        Largest angle of incidence, in (0, 90); a cell counts as lit if its signal over its
        reference current is at least the cosine of this angle. The default leaves four of sixteen
        evenly spread cells in every direction.

    Attributes
    ----------
    reference_ : ndarray, shape (K,)
        Current of every cell under perpendicular sunlight, in units of the features.

    Notes
    -----
    Implements: eq:msfpano (model:pano, Zhang2022b): ``s = (A^T W A)^-1 A^T W (I_i / I_max,i)``
    over lit cells, A their installation vectors. The survey prints ``W A^T`` as the last factor;
    corrected because only ``A^T W`` is weighted least squares (and of the right shape). The
    temperature term ``K (T_i - T_0)`` needs a thermometer on every cell, which signals do not
    hold: it is left out, and ``I_max`` is learnt, one a cell, by least squares of the calibration
    signals on the cosines up to `largest_incidence_deg`; a cell that no sample lights takes the
    others' mean. W is left open there, and the lit cells' choice is stated in words.

    Failure: a NaN row for a NaN feature row, and where fewer than three cells are lit or those lit
    look along one plane. fit raises UnusableDataError where no sample lights a cell. Albedo is not
    distinguished from sunlight. for_sensor refuses bodies that leave directions of their field
    unsolved, as cubes do.

    Cost: 21 operations per cell, 30 per sample.

    Examples
    --------
    >>> import numpy as np
    >>> normals = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> sun = np.array([[0.0, 0.0, 1.0], [0.28, 0.0, 0.96], [0.0, -0.28, 0.96]])
    >>> signals = np.maximum(sun @ np.array(normals).T, 0.0) * (1.0, 1.1, 0.9, 1.0)
    >>> model = WeightedCells(normals).fit(signals, sun)
    >>> model.reference_.round(3)
    array([1. , 1.1, 0.9, 1. ])
    >>> model.predict(signals[1:2]).round(3)
    array([[0.28, 0.  , 0.96]])
    """

    about: ClassVar = AboutModel(
        name="panoramic",
        taxonomy="Panoramic",
        studies=("Zhang2022b",),
        labels=("model:pano", "eq:msfpano"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: Normals
    weighting: Weighting = "signal"
    largest_incidence_deg: float = 75.0

    reference_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_normals(self.face_normals, self.about.name)
        require_choice(self.about.name, Weighting, weighting=self.weighting)
        require_within(self.about.name, "(0, 90)", largest_incidence_deg=self.largest_incidence_deg)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's cells.

        UnsuitableDesignError where, by the drawing, a direction of the field lights fewer than 3.
        """
        cls.about.require_kind(kind)
        geometry.require("face_normals", by=cls.about.name)
        model = cls(geometry.face_normals or ())
        field_of_view = directions(geometry.half_fov_deg)
        cosines = field_of_view @ np.asarray(model.face_normals, dtype=np.float64).T
        fewest = int((cosines >= model._smallest_cosine).sum(axis=1).min())
        if fewest < FEWEST_LIT:
            raise UnsuitableDesignError(
                f"{cls.about.name} needs three cells lit within "
                f"{model.largest_incidence_deg:g} deg of "
                f"incidence in every direction of the field; {len(model.face_normals)} faces "
                f"leave {fewest}"
            )
        return model

    def columns(self) -> int:
        """One a cell."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the reference current of every cell."""
        del context
        normals = np.asarray(self.face_normals, dtype=np.float64)
        cosines = sun @ normals.T
        cosines[cosines < self._smallest_cosine] = 0.0
        squares = (cosines**2).sum(axis=0)
        lit = squares > 0
        require_samples(int(lit.sum()), 1, self.about.name, "that light a cell")
        reference = np.full(len(normals), np.nan)
        reference[lit] = (features * cosines).sum(axis=0)[lit] / squares[lit]
        reference[~lit] = reference[lit].mean()
        if not (reference > 0).all():
            raise UnusableDataError(
                f"{self.about.name}: cells turned to the Sun must have positive signals; the "
                f"calibration gives a reference current of {reference.min():.6g}"
            )
        self.reference_ = reference

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, K)."""
        del context
        relative = features / self.reference_
        lit = relative >= self._smallest_cosine
        weights = np.where(lit, relative if self.weighting == "signal" else 1.0, 0.0)

        # the six different elements of A^T W A and the three of A^T W I, added cell by cell
        elements, right = np.zeros((6, len(features))), np.zeros((3, len(features)))
        for column, (x, y, z) in enumerate(self.face_normals):
            weight = weights[:, column]
            for k, product in enumerate((x * x, x * y, x * z, y * y, y * z, z * z)):
                elements[k] += product * weight
            pull = weight * np.where(lit[:, column], relative[:, column], 0.0)
            for k, component in enumerate((x, y, z)):
                right[k] += component * pull
        vectors, determinant = _adjugate_product(elements, right)

        trace = elements[0] + elements[3] + elements[5]
        # fewer than three lit, or three in a plane: rounding is all there is of a determinant
        vectors[~(determinant > FLATTEST * trace**3)] = np.nan
        return normalise(vectors)

    @property
    def _smallest_cosine(self) -> float:
        return float(np.cos(np.radians(self.largest_incidence_deg)))


def _adjugate_product(elements: Floats, right: Floats) -> tuple[Floats, Floats]:
    """``adj(M) v`` (N, 3) and ``det(M)`` (N,) of symmetric M: the solution's direction.

    Parameters
    ----------
    elements : ndarray, shape (6, N)
        ``M_xx, M_xy, M_xz, M_yy, M_yz, M_zz``.
    right : ndarray, shape (3, N)
        v.
    """
    xx, xy, xz, yy, yz, zz = elements
    a, b, c = right
    first, second, third = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    middle, lower, last = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    product = np.column_stack(
        [
            first * a + second * b + third * c,
            second * a + middle * b + lower * c,
            third * a + lower * b + last * c,
        ]
    )
    return product, xx * first + xy * second + xz * third
