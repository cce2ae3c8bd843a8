"""Sun and albedo distinguished face by face, with a magnetometer where it takes one (SAIE)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.cube_currents import CubeCurrents
from algorithms.contract import AboutCompensation, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.parameters import require_within
from algorithms.row_arithmetic import normalise

#: Ways to give each of three pairs' plus face to the Sun (+1) or to the Earth (-1).
_SIDES = tuple(product((1.0, -1.0), repeat=3))


@documented
@dataclass
class SunAndAlbedoInputs(CubeCurrents):
    """Sunlight share of each face's current, in closed form from the known solar strength.

    If both faces of a pair are lit, the Sun lights one and the Earth the other; if only one is lit,
    it may receive both. Unit length resolves one shared face; a magnetometer and the almanac
    resolve two; three cannot be resolved.

    Parameters
    ----------
    tolerance : float
        Relative error of currents, in (0, 0.5): up to it a face is dark, a length is one, a share
        may be larger than the face's current.

    Notes
    -----
    Implements: eq:albedo3a, eq:albedo3b (model:albedo, Frezza2022). Type 0, no face shared: the
    Sun's are those of the lit faces whose squares add up to one. Type 1, one shared: its share is
    ``sqrt(1 - sum of the others' squares)``. Type 2, two shared: the Sun lies on a cone around the
    field, ``s . b = s_i . b_i`` with the inertial vectors of almanac and field model. Unit length
    leaves two points on this cone, of which one must be possible. Type 3: no
    solution, unless currents have length one: then nothing is the Earth's. The survey shows one
    example a type; sides are tried in turn here, and what two ways explain is no answer.

    Shapes: signals (N, 6), in any common unit, to the same. Context: ``magnetic_field_nT``,
    ``sun_inertial`` and ``magnetic_field_inertial_nT``, (N, 3) each.

    Failure: a NaN row for a NaN row of features or context, for type 3 with albedo, and where no
    way or several different ones fit. fit raises UnusableDataError where no sample lights a face.

    Cost: 8 sides of 40 operations per sample.

    Examples
    --------
    >>> import numpy as np
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> field = {"magnetic_field_nT": [[3e4, 0.0, 0.0]], "sun_inertial": [[0.0, 0.6, 0.8]],
    ...          "magnetic_field_inertial_nT": [[3e4, 0.0, 0.0]]}
    >>> clean = SunAndAlbedoInputs(faces).fit([[0, 0, 0.6, 0, 0.8, 0]], [[0.0, 0.6, 0.8]], field)
    >>> seen = [[0.1, 0.0, 0.6, 0.0, 0.8, 0.2]]  # the Earth on +x and -z
    >>> clean.transform(seen, field).round(3)
    array([[0. , 0. , 0.6, 0. , 0.8, 0. ]])
    """

    about: ClassVar = AboutCompensation(
        name="sun-and-albedo-inputs",
        taxonomy="ICM/Albedo",
        studies=("Frezza2022",),
        labels=("model:albedo", "eq:albedo3a", "eq:albedo3b"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("magnetic_field_nT", "sun_inertial", "magnetic_field_inertial_nT"),
        ahead_of=("basic",),
    )

    tolerance: float = 0.02

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within(self.about.name, "(0, 0.5)", tolerance=self.tolerance)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, 6) of the Sun alone."""
        plus, minus = self.pairs(features)
        field = normalise(context["magnetic_field_nT"])
        along = (context["sun_inertial"] * normalise(context["magnetic_field_inertial_nT"])).sum(
            axis=1
        )
        candidates = [
            candidate
            for sides in _SIDES
            for candidate in self._of_sides(plus, minus, np.array(sides), field, along)
        ]
        return self.lit_by(self._agree(np.stack(candidates)))

    def _of_sides(
        self, plus: Floats, minus: Floats, sides: Floats, field: Floats, along: Floats
    ) -> list[Floats]:
        """Sun vectors (N, 3) with the Sun on these sides, four ways; NaN where impossible."""
        seen = np.where(sides > 0, plus, minus)
        other = np.where(sides > 0, minus, plus)
        dark = self.tolerance
        # the Earth on the other face of a pair: this one is the Sun's alone
        shared = (other <= dark) & (seen > dark)
        alone = np.where(shared, 0.0, np.where(seen > dark, seen, 0.0))
        # no light on this side and some on the other: the Sun may be square to the pair
        count = shared.sum(axis=1)
        length = (alone**2).sum(axis=1)
        left = np.maximum(1.0 - length, 0.0)

        everything = np.where((np.abs(_length(seen) - 1.0) <= dark)[:, None], seen, np.nan)
        everything[count != 3] = np.nan
        none = np.where((np.abs(np.sqrt(length) - 1.0) <= dark)[:, None], alone, np.nan)
        none[count != 0] = np.nan
        one = np.where(shared, np.sqrt(left)[:, None], alone)
        one[(count != 1) | (length > 1.0 + dark)] = np.nan
        first, second = self._on_cone(alone, shared, left, sides[None] * field, along)
        found = [everything, none, one, first, second]
        for vector in found:
            possible = ((vector >= -dark) & (vector <= seen + dark)).all(axis=1)
            vector[~possible] = np.nan
        return [np.asarray(vector * sides) for vector in found]

    def _on_cone(
        self,
        alone: Floats,
        shared: NDArray[np.bool_],
        left: Floats,
        field: Floats,
        along: Floats,
    ) -> tuple[Floats, Floats]:
        """Both vectors (N, 3) of the length and the cone with two faces shared; NaN elsewhere."""
        two = shared.sum(axis=1) == 2
        axes = np.argsort(~shared, axis=1, kind="stable")  # shared ones first
        rows = np.arange(len(alone))
        p, q = field[rows, axes[:, 0]], field[rows, axes[:, 1]]
        wanted = along - (alone * field).sum(axis=1)
        across = p * p + q * q
        with np.errstate(divide="ignore", invalid="ignore"):
            square = left * across - wanted * wanted
            # a cone that noise keeps from the circle touches it
            root = np.sqrt(np.where(square < -self.tolerance * across, np.nan, square.clip(0.0)))
            solutions = []
            for sign in (1.0, -1.0):
                found = alone.copy()
                found[rows, axes[:, 0]] = (wanted * p - sign * root * q) / across
                found[rows, axes[:, 1]] = (wanted * q + sign * root * p) / across
                found[~two] = np.nan
                solutions.append(found)
        return solutions[0], solutions[1]

    def _agree(self, candidates: Floats) -> Floats:
        """Mean (N, 3) of the possible vectors (C, N, 3) where they agree, else NaN."""
        known = np.asarray(np.isfinite(candidates).all(axis=2))
        count = known.sum(axis=0)
        total = np.where(known[:, :, None], candidates, 0.0).sum(axis=0)
        mean = total / np.maximum(count, 1)[:, None]
        off = np.where(known, _length(candidates - mean), 0.0).max(axis=0)
        mean[(count == 0) | (off > 2.0 * self.tolerance)] = np.nan
        return np.asarray(mean)


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt((vectors**2).sum(axis=-1)))
