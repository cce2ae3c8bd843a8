"""More masks of coded groups: by spacing and size (Wang2015), by oblique places (Wei2017)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from benchmark.simulator.masks.apertures import Aperture, Mask


def spacing_and_size_coded(
    subfields: int,
    *,
    pitch_mm: float,
    narrow_mm: float,
    wide_mm: float,
    first_mm: float,
    step_mm: float,
    focal_length_mm: float,
    thickness_mm: float = 0.0,
) -> Mask:
    """Return groups of three round apertures that spacing and size name together (Wang2015).

    Group (i, j) of `subfields` x `subfields`, i along x, has a corner aperture, one at
    ``first + floor(i / 2) step`` in +x, wide where i is odd, and one at ``first + floor(j / 2)
    step`` in +y, wide where j is odd; sizes take over every second name, so that spacings differ
    by twice as much as they would alone. All diameters of a group are ``sqrt(1/cos(theta))`` times
    the drawn ones, to a tenth, theta the incidence under which it is seen: that keeps the Fresnel
    number along the slant ray, the best a hole can have by the theory of diffraction.

    Groups stand on a square lattice of `pitch_mm`. Ordered row of groups by row, in a group
    corner, +x, +y.

    Raises
    ------
    ValueError
        When holes could overlap, sizes are not two, or a gap between groups could be read as a
        code.
    """
    longest = first_mm + (subfields - 1) // 2 * step_mm
    edge = (subfields - 1) / 2.0 * pitch_mm
    steepest = round(math.sqrt(math.hypot(1.0, math.sqrt(2.0) * edge / focal_length_mm)), 1)
    if not 0.0 < narrow_mm < wide_mm:
        raise ValueError(f"narrow_mm must be below wide_mm; got {narrow_mm} and {wide_mm}")
    if first_mm <= wide_mm * steepest:
        raise ValueError(
            f"first_mm must exceed the largest diameter of {wide_mm * steepest:.4g} mm; "
            f"got {first_mm}"
        )
    if pitch_mm - longest <= longest + step_mm:
        raise ValueError(
            f"spacings up to {longest:.4g} mm are ambiguous in cells of {pitch_mm:.4g} mm: the "
            f"gap to the next group must exceed {longest + step_mm:.4g} mm"
        )
    holes = []
    back = (first_mm + longest) / 4.0  # half the mean spacing
    sizes = (narrow_mm, wide_mm)
    for j in range(subfields):
        for i in range(subfields):
            across = (i - (subfields - 1) / 2.0) * pitch_mm
            along = (j - (subfields - 1) / 2.0) * pitch_mm
            slant = math.hypot(1.0, math.hypot(across, along) / focal_length_mm)
            wider = round(math.sqrt(slant), 1)
            x, y = across - back, along - back
            holes += [
                _hole(narrow_mm * wider, x, y),
                _hole(sizes[i % 2] * wider, x + first_mm + i // 2 * step_mm, y),
                _hole(sizes[j % 2] * wider, x, y + first_mm + j // 2 * step_mm),
            ]
    return Mask(tuple(holes), thickness_mm)


def oblique_coded(
    orders: Sequence[Sequence[int]],
    *,
    pitch_mm: float,
    cell_mm: float,
    diameter_mm: float,
    thickness_mm: float = 0.0,
) -> Mask:
    """Return seven groups of round apertures placed obliquely, without symmetry (Wei2017).

    One group in the middle and six around it, `pitch_mm` apart, the first of them along +x. The
    n-th aperture of group k is in column n and row ``orders[k][n]`` of a square of cells: none
    shares a row or a column, so that each shows by itself in the sums over rows and over columns,
    which are all that the study's detector reads out. Columns and rows widen by a tenth of a cell
    one after the other, so that no group looks the same from two sides.

    Raises
    ------
    ValueError
        When there are not seven different orders of the same rows, or holes could overlap.
    """
    rows = sorted(orders[0])
    if len(orders) != 7 or any(sorted(order) != rows for order in orders):
        raise ValueError("orders must be seven, each of the same rows")
    if rows != list(range(len(rows))) or len({tuple(order) for order in orders}) != len(orders):
        raise ValueError("orders must be different orders of rows 0, 1, 2 and so on")
    if cell_mm <= diameter_mm:
        raise ValueError(f"cell_mm must exceed the diameter of {diameter_mm} mm; got {cell_mm}")
    middles = [(0.0, 0.0)]
    for k in range(6):
        turn = math.pi / 3.0 * k
        middles.append((pitch_mm * math.cos(turn), pitch_mm * math.sin(turn)))
    place = [cell_mm * (n + 0.05 * n * (n - 1)) for n in rows]
    half = place[-1] / 2.0
    return Mask(
        tuple(
            _hole(diameter_mm, x + place[n] - half, y + place[row] - half)
            for (x, y), order in zip(middles, orders, strict=True)
            for n, row in enumerate(order)
        ),
        thickness_mm,
    )


def _hole(diameter_mm: float, x_mm: float, y_mm: float) -> Aperture:
    # drawings are made in tenths of a micrometre
    return Aperture(
        "round", round(diameter_mm, 4), round(diameter_mm, 4), round(x_mm, 4), round(y_mm, 4)
    )
