"""Differences of signals in standard deviations of their noise: `Whitening`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.readout.column_noise import CommonNoise


@dataclass(frozen=True, eq=False)
class Whitening:
    """Readings with noise of their own, and noise that groups of them share.

    The covariance of a sample is ``C = D^(1/2) (1 + sum_k u_k u_k^T) D^(1/2)``, D diagonal and
    ``u_k`` the group's common deviation over its elements' own, 0 elsewhere. Groups have no element
    in common, so that the root's inverse is known in closed form, term by term:
    ``(1 + u u^T)^(-1/2) = 1 - (1 - 1 / sqrt(1 + u.u)) u u^T / u.u``. Scalar products of differences
    that are so divided are then those over ``C^-1`` (Woodbury's identity with rank one a group).

    Attributes
    ----------
    deviation
        (N, M) of the elements' own noise; inf for elements that tell nothing.
    common
        Noise that elements share; None for none.
    """

    deviation: Floats
    common: CommonNoise | None = None

    def whiten(self, difference: Floats) -> Floats:
        """Divide differences (N, M) by the root of the covariance, in place."""
        difference /= self.deviation
        if self.common is not None:
            self._stretch(difference, self._shrink)
        return difference

    def undone(self, white: Floats) -> Floats:
        """Make the differences (N, M) again of which `whiten` made these; in place.

        Those of elements that tell nothing stay 0.
        """
        if self.common is not None:
            self._stretch(white, self._grow)
        white *= np.where(np.isfinite(self.deviation), self.deviation, 0.0)
        return white

    @property
    def _shared(self) -> CommonNoise:
        if self.common is None:
            raise TypeError("there is no common noise")
        return self.common

    @cached_property
    def _groups(self) -> int:
        group = self._shared.group
        return group if isinstance(group, int) else int(np.max(group)) + 1

    @cached_property
    def _places(self) -> NDArray[np.int64] | None:
        """(N, M) group of every element; None for rows of columns."""
        if isinstance(self._shared.group, int):
            return None
        return np.broadcast_to(self._shared.group, self.deviation.shape)

    @cached_property
    def _loading(self) -> Floats:
        """(N, M) common deviation over each element's own: all groups' u in one."""
        return np.asarray(self._shared.deviation / self.deviation)

    @cached_property
    def _square(self) -> Floats:
        """(N, G) u.u of all groups of all samples."""
        return self._along(self._loading)

    @cached_property
    def _shrink(self) -> Floats:
        root = np.sqrt(1.0 + self._square)
        # (1 - 1 / root) / u.u without a difference of equals
        return np.asarray(-1.0 / (root * (1.0 + root)))

    @cached_property
    def _grow(self) -> Floats:
        return np.asarray(1.0 / (1.0 + np.sqrt(1.0 + self._square)))

    def _rows(self, vectors: Floats) -> Floats:
        """View (N, M) as (N, rows, columns)."""
        return vectors.reshape(len(vectors), -1, self._groups)

    def _along(self, vectors: Floats) -> Floats:
        """(N, G) products of vectors (N, M) with each u."""
        if self._places is None:
            rows = self._rows(self._loading), self._rows(vectors)
            return np.asarray(np.einsum("nrc,nrc->nc", *rows))
        from benchmark.metrics.grouped_kernel import products  # noqa: PLC0415 - Numba on demand

        out = np.zeros((len(self.deviation), self._groups))
        products(out, self._places, self._loading, vectors)
        return out

    def _stretch(self, vectors: Floats, factor: Floats) -> None:
        """Add to vectors (N, M) their products with each u, times a factor of its, times u."""
        along = self._along(vectors) * factor
        if self._places is None:
            rows = self._rows(vectors)
            rows += self._rows(self._loading) * along[:, None]
        else:
            from benchmark.metrics.grouped_kernel import add_along  # noqa: PLC0415 - Numba on demand

            add_along(vectors, self._places, self._loading, along)
