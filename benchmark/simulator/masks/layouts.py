"""Regular masks: grids of equal apertures, and slits."""

from __future__ import annotations

from dataclasses import replace

from benchmark.simulator.masks.apertures import Aperture, Mask


def grid(
    columns: int, rows: int, spacing_mm: float, aperture: Aperture, thickness_mm: float = 0.0
) -> Mask:
    """Return `columns` x `rows` copies of `aperture`, centred on the detector, row by row.

    The aperture's own position shifts the whole grid.

    Raises
    ------
    ValueError
        When there is no column or row, or neighbours would overlap.
    """
    if columns < 1 or rows < 1:
        raise ValueError(f"a grid needs at least one column and one row; got {columns} x {rows}")
    widest = max(aperture.width_mm, aperture.height_mm)
    if columns * rows > 1 and spacing_mm <= widest:
        raise ValueError(f"spacing_mm must exceed the aperture's {widest} mm; got {spacing_mm}")
    return Mask(
        tuple(
            replace(
                aperture,
                x_mm=aperture.x_mm + (column - (columns - 1) / 2.0) * spacing_mm,
                y_mm=aperture.y_mm + (row - (rows - 1) / 2.0) * spacing_mm,
            )
            for row in range(rows)
            for column in range(columns)
        ),
        thickness_mm,
    )


def slit(
    width_mm: float, length_mm: float, rotation_deg: float = 0.0, thickness_mm: float = 0.0
) -> Mask:
    """Return one slit over the detector's centre, along y unless rotated.

    Raises
    ------
    ValueError
        When it is wider than long, so that its direction is not the one named.
    """
    if width_mm > length_mm:
        raise ValueError(f"a slit is longer than wide; got {width_mm} x {length_mm} mm")
    return Mask(
        (Aperture("rectangle", width_mm, length_mm, rotation_deg=rotation_deg),), thickness_mm
    )


def l_slit(
    width_mm: float,
    line_mm: float,
    along_y_mm: tuple[float, float],
    along_x_mm: tuple[float, float],
    thickness_mm: float = 0.0,
) -> Mask:
    """Return two slits at right angles, whose middle lines lie at `line_mm` of x and of y.

    `along_y_mm` and `along_x_mm` are the middle and the length of either.
    """
    (y_mm, y_long_mm), (x_mm, x_long_mm) = along_y_mm, along_x_mm
    return Mask(
        (
            Aperture("rectangle", width_mm, y_long_mm, x_mm=line_mm, y_mm=y_mm),
            Aperture("rectangle", x_long_mm, width_mm, x_mm=x_mm, y_mm=line_mm),
        ),
        thickness_mm,
    )
