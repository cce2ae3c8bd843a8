"""What a sensor reads of a Sun, learnt from a calibration: of faces under albedo, and of spots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from algorithms.calibration.blocks import between_poses, folds
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.calibration.quality import Setting
from algorithms.contract import Floats, UnusableDataError
from algorithms.filtering import readings_kernel as kernel

#: Share of full sunlight below which a face is dark.
_DARK = 0.2
#: Order of a spot's polynomial, at most.
_HIGHEST = 7
#: Of singular values, below which equations have no solution of their own.
_SMALLEST = 1e-9


class Readings(Protocol):
    """How readings follow from a state, once learnt."""

    @property
    def count(self) -> int:
        """Numbers read at a time."""
        ...

    @property
    def middle_k(self) -> float:
        """Temperature, kelvin, from which warmth counts."""
        ...

    def at(
        self, states: Floats, chosen: Floats, known: Floats, turn: int = 0
    ) -> tuple[Floats, Floats]:
        """Give readings (B, m) and their derivatives (B, m, n).

        The head's turn is in a state from `turn` on; there is none where that is 0.
        """
        ...

    def settings(self) -> dict[str, Setting]:
        """Give what the calibration samples chose."""
        ...

    def is_sunlit(self, features: Floats) -> Floats:
        """Whether (N,) features (N, m) are of sunlight, as far as they tell."""
        ...


@dataclass(frozen=True)
class FaceReadings:
    """Signals of faces: a cubic of the cosine of incidence each, and what the Earth adds.

    Attributes
    ----------
    design : ndarray, shape (K, 16)
        As `algorithms.filtering.readings_kernel.faces` takes it.
    albedo : ndarray, shape (12,)
        Likewise.
    middle_k : float
        Temperature from which warmth counts.
    """

    design: Floats
    albedo: Floats
    middle_k: float

    @property
    def count(self) -> int:
        """One a face."""
        return len(self.design)

    def at(
        self, states: Floats, chosen: Floats, known: Floats, turn: int = 0
    ) -> tuple[Floats, Floats]:
        """Signals (B, K) and their derivatives."""
        found: tuple[Floats, Floats] = kernel.faces(
            states, chosen, known, turn, self.design, self.albedo
        )
        return found

    def settings(self) -> dict[str, Setting]:
        """Give nothing: nothing was to be chosen."""
        return {}

    def is_sunlit(self, features: Floats) -> Floats:
        """Whether a face has a fifth of full sunlight: on a closed body the Sun gives one more."""
        brightest = ((features - self.design[:, 9]) / self.design[:, 14]).max(axis=1)
        return np.asarray(brightest > _DARK, dtype=np.float64)

    @classmethod
    def from_calibration(
        cls, normals: Floats, signals: Floats, sun: Floats, known: Floats, by: str
    ) -> FaceReadings:
        """Least squares, twice: the second time about the tilts that the first one found.

        Parameters
        ----------
        normals : ndarray, shape (K, 3)
            Of the drawing.
        signals, sun, known : ndarray, shapes (n, K), (n, 3) and (n, 7)
            Of the calibration.
        by : str
            Whose, for messages.
        """
        middle = float(known[:, 6].mean())
        warmth = known[:, 6] - middle
        faces = len(normals)
        axes = [_axes_across(normal) for normal in normals]
        full = _full_signals(signals, sun, normals, by)
        looks = normals.copy()
        for _ in range(2):
            cosines = np.maximum(sun @ looks.T, 0.0)
            own, shared, right = [], [], []
            for k in range(faces):
                c, up = cosines[:, k], (cosines[:, k] > 0).astype(np.float64)
                tilts = [up * (sun @ axis) for axis in axes[k]]
                own.append(
                    np.column_stack([np.ones(len(c)), c, c**2, c**3, *tilts, c * warmth, up])
                )
                shared.append(earth_columns(sun, known[:, 3:6], looks[k])[:, 1:])
                right.append(signals[:, k] / full[k])
            columns = own[0].shape[1]
            matrix = np.zeros((faces * len(sun), faces * columns + shared[0].shape[1]))
            for k in range(faces):
                rows = slice(k * len(sun), (k + 1) * len(sun))
                matrix[rows, k * columns : (k + 1) * columns] = own[k]
                matrix[rows, faces * columns :] = shared[k]
            solved, singular = _least_squares(matrix, np.concatenate(right))
            if not singular[-1] > _SMALLEST * singular[0]:
                raise UnusableDataError(
                    f"{by}: the calibration samples do not settle how {faces} faces respond and "
                    "what the Earth adds; they must light every face from all sides"
                )
            numbers = solved[: faces * columns].reshape(faces, columns)
            # what is the same at all times and on all faces counts as dark signal
            albedo = np.concatenate([[0.0], solved[faces * columns :]])
            # a tilt moves a cosine: over the response's slope at 1 it is an angle
            slope = np.maximum(numbers[:, 1] + 2 * numbers[:, 2] + 3 * numbers[:, 3], 0.1)
            for k in range(faces):
                off = (numbers[k, 4] * axes[k][0] + numbers[k, 5] * axes[k][1]) / slope[k]
                looks[k] = (looks[k] + off) / np.linalg.norm(looks[k] + off)
        design = np.zeros((faces, 16))
        for k in range(faces):
            design[k, 0:3], design[k, 3:6], design[k, 6:9] = looks[k], *axes[k]
            response = numbers[k, [0, 1, 2, 3, 6]] * full[k]
            design[k, 9:14] = response
            # the published response of photodiodes has a step where light begins (eq:kellycos)
            design[k, 15] = numbers[k, 7] * full[k]
            design[k, 14] = response[1:4].sum() + design[k, 15]
        # the kernel scales what the Earth adds by the response at 1
        ratio = float(np.mean(full / design[:, 14]))
        return cls(design, albedo * ratio, middle)


@dataclass(frozen=True)
class SpotReadings:
    """Where a spot falls, or how a balance stands: a polynomial of the tangents.

    Its centre and scale follow warmth.

    Attributes
    ----------
    powers, design, warm : ndarray, shapes (q, 2), (q, 2) and (3, 2)
        As `algorithms.filtering.readings_kernel.spots` takes them.
    middle_k : float
        Temperature from which warmth counts.
    """

    powers: Floats
    design: Floats
    warm: Floats
    middle_k: float

    @property
    def count(self) -> int:
        """A column and a row."""
        return 2

    def at(
        self, states: Floats, chosen: Floats, known: Floats, turn: int = 0
    ) -> tuple[Floats, Floats]:
        """Spots (B, 2) and their derivatives."""
        found: tuple[Floats, Floats] = kernel.spots(
            states, chosen, known, turn, self.powers, self.design, self.warm
        )
        return found

    def is_sunlit(self, features: Floats) -> Floats:
        """Say nothing: a spot does not tell what made it."""
        return np.ones(len(features))

    def settings(self) -> dict[str, Setting]:
        """Give the order of the polynomial."""
        return {"order": int(self.powers.sum(axis=1).max())}

    @classmethod
    def from_calibration(cls, spots: Floats, sun: Floats, known: Floats, by: str) -> SpotReadings:
        """Least squares of spots (n, 2) px, of Suns (n, 3) and what is known (n, 7).

        The order, up to 7, is the one that does best on poses left out.
        """
        middle = float(known[:, 6].mean())
        warmth = known[:, 6] - middle
        beta, alpha = sun[:, 0] / sun[:, 2], sun[:, 1] / sun[:, 2]
        powers = [(order - j, j) for order in range(_HIGHEST + 1) for j in range(order + 1)]
        sizes = [3 + (order + 1) * (order + 2) // 2 for order in range(1, _HIGHEST + 1)]
        at = np.column_stack([beta, alpha, warmth])
        design = _spot_terms(at, powers)
        between = _spot_terms(between_poses(sun, at), powers)
        errors = errors_of_orders(design, sizes, spots, folds(sun), between)
        size = sizes[choose_order(errors, by).order]
        solved, singular = _least_squares(design[:, :size], spots)
        if not singular[-1] > _SMALLEST * singular[0]:
            raise UnusableDataError(
                f"{by}: the calibration samples do not settle where spots fall; they must spread "
                "over the field of view"
            )
        found = np.asarray(powers[: size - 3], dtype=np.float64)
        return cls(found, solved[3:].copy(), solved[:3].copy(), middle)


def _spot_terms(at: Floats, powers: list[tuple[int, int]]) -> Floats:
    """(n, 3 + powers) terms of spots at the two tangents of the Sun and the warmth (n, 3)."""
    beta, alpha, warmth = at.T
    columns = [warmth, warmth * beta, warmth * alpha]
    return np.column_stack([*columns, *(beta**i * alpha**j for i, j in powers)])


def earth_columns(sun: Floats, nadir: Floats, normal: Floats) -> Floats:
    """(n, 12) what the sunlit Earth may add to a face, a column a coefficient.

    Of ``z^i u^j`` (i, j = 0..2), ``w``, ``w u``, ``w z``; see the kernel.
    """
    zenith = -(sun * nadir).sum(axis=1)
    towards = nadir @ normal
    side = sun @ normal + towards * zenith
    columns = [zenith**i * towards**j for i in range(3) for j in range(3)]
    return np.column_stack([*columns, side, side * towards, side * zenith])


def _full_signals(signals: Floats, sun: Floats, normals: Floats, by: str) -> Floats:
    """(K,) a first guess of each face's signal under perpendicular sunlight."""
    cosines = sun @ normals.T
    cosines[cosines < 0.3] = 0.0
    squares = (cosines**2).sum(axis=0)
    if (squares > 0).all():
        full = (signals * cosines).sum(axis=0) / squares
        if (full > 0).all():
            return np.asarray(full)
    raise UnusableDataError(f"{by}: every face must be lit, with a positive signal, by a sample")


def _least_squares(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Solution, and singular values of the columns brought to one length."""
    lengths = np.sqrt((matrix**2).sum(axis=0))
    lengths[lengths == 0] = 1.0
    solved, _, _, singular = np.linalg.lstsq(matrix / lengths, right, rcond=None)
    return np.asarray((solved.T / lengths).T), singular


def _axes_across(normal: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors across a normal and each other."""
    first = np.cross(np.eye(3)[int(np.abs(normal).argmin())], normal)
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)
