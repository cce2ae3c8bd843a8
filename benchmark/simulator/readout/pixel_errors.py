"""What real pixels do to their light beside noise and a spread of gains: `PixelErrors`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Literal

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator


@lru_cache(maxsize=5)  # all kinds of one unit
def drawn(
    kind: Literal["normal", "uniform", "exponential"], shape: tuple[int, ...], *names: str | int
) -> Floats:
    """Draw a number for each pixel of `shape`, read-only: of a unit always the same ones."""
    stream = generator(*names)
    if kind == "exponential":
        found = stream.standard_exponential(shape, method="inv")
    else:
        found = stream.random(shape) if kind == "uniform" else stream.standard_normal(shape)
    found.flags.writeable = False
    return found


@dataclass(frozen=True)
class PixelErrors:
    """Systematic errors of a pixel array; all off by default.

    In the order in which they act: light makes charge, some of which wanders to the neighbours
    (`crosstalk`); while a frame-transfer CCD shifts its image under the mask, every pixel of a
    column gathers a little of all the others' light (`smear`); hot pixels add dark charge of their
    own (`hot`); the amplifier's slope falls with the charge (`nonlinearity`); and every column has
    an amplifier with an offset of its own, which stays (`column_offset_e`) or changes from frame
    to frame (`column_noise_e`).

    Attributes
    ----------
    crosstalk
        Share of a pixel's charge that its four neighbours collect, a quarter each; of a linear
        array's, the two.
    smear
        Time of shifting the image by one row over the exposure.
    hot
        Share of the pixels that are hot: protons displace atoms of the lattice, and each such
        place gives off charge. Grows with the dose.
    hot_factor
        Mean dark signal of a hot pixel over that of the others; exponentially distributed.
    nonlinearity
        Share by which a full well falls short of proportion; less charge falls short with its
        square.
    column_offset_e, column_noise_e
        Standard deviations over columns, and over frames.
    """

    crosstalk: float = 0.0
    smear: float = 0.0
    hot: float = 0.0
    hot_factor: float = 50.0
    nonlinearity: float = 0.0
    column_offset_e: float = 0.0
    column_noise_e: float = 0.0

    def __post_init__(self) -> None:
        for one in fields(self):
            if not getattr(self, one.name) >= 0:
                raise ValueError(f"{one.name} must not be negative; got {getattr(self, one.name)}")
        if self.crosstalk > 0.5 or self.nonlinearity >= 0.5 or self.hot > 1:
            raise ValueError(
                "crosstalk must be at most 0.5, nonlinearity below 0.5 and hot at most 1; got "
                f"{self.crosstalk}, {self.nonlinearity} and {self.hot}"
            )

    def dark_factor(self, shape: tuple[int, ...], *names: str | int) -> Floats:
        """Return what the dark signal of every pixel of the unit of this name is multiplied by.

        Pixels turn hot in an order of their own: those of a smaller dose are hot under a larger
        one, too.
        """
        turn = drawn("uniform", shape, *names, "hot")
        strength = drawn("exponential", shape, *names, "hot-dark")
        return np.where(turn < self.hot, 1.0 + self.hot_factor * strength, 1.0)

    def column_offsets(self, columns: int, *names: str | int) -> Floats:
        """Return the electrons (columns,) by which the columns of this unit read too much."""
        return self.column_offset_e * generator(*names, "columns").standard_normal(columns)

    def gather(self, light: Floats) -> Floats:
        """Charge of frames (N, H, W) or profiles (N, W) of the light that falls on their pixels.

        Beyond the edges the light goes on as it is at them. An image is shifted under the mask
        with the rows that are read out alone: a window's gathers the light of the window.
        """
        if light.ndim == 2:  # a line shifts no image
            return _spill(light, self.crosstalk) if self.crosstalk else light
        if not self.moves_charge:
            return light
        from benchmark.simulator.kernels.digitising import gather  # noqa: PLC0415 - Numba on demand

        out = np.empty(light.shape)
        for frame, seen in zip(out, np.ascontiguousarray(light), strict=True):
            gather(frame, seen, (0.0, self.crosstalk, self.smear))
        return out

    @property
    def moves_charge(self) -> bool:
        """Whether `gather` is any other than the light."""
        return self.crosstalk > 0.0 or self.smear > 0.0

    @property
    def of_amplifiers(self) -> bool:
        """Whether amplifiers bend the signal, or differ from column to column."""
        return max(self.nonlinearity, self.column_offset_e, self.column_noise_e) > 0.0

    def read(self, electrons: Floats, full_well_e: float) -> Floats:
        """Electrons (...) as the amplifier shows them: ``e (1 - n e / full well)``."""
        if not self.nonlinearity:
            return electrons
        return np.asarray(electrons * (1.0 - self.nonlinearity / full_well_e * electrons))

    def held(self, read: Floats, full_well_e: float) -> Floats:
        """Electrons (...) held where the amplifier shows these: the inverse of `read`."""
        if not self.nonlinearity:
            return read
        bend = self.nonlinearity / full_well_e
        # the smaller root, without a difference of equals; beyond the vertex there is none
        square = np.maximum(1.0 - 4.0 * bend * read, 0.0)
        return np.asarray(2.0 * read / (1.0 + np.sqrt(square)))

    def slope(self, electrons: Floats, full_well_e: float) -> Floats:
        """Change (...) of what is read with what is held."""
        return np.asarray(1.0 - 2.0 * self.nonlinearity / full_well_e * electrons)


def _spill(light: Floats, share: float) -> Floats:
    """Give a share of every pixel of profiles (N, W) to its two neighbours."""
    out = (1.0 - share) * light
    part = share / 2.0 * light
    out[:, 1:] += part[:, :-1]
    out[:, :-1] += part[:, 1:]
    # beyond the ends the light goes on
    out[:, 0] += part[:, 0]
    out[:, -1] += part[:, -1]
    return out
