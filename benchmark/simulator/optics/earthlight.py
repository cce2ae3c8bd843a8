"""Light of the sunlit Earth through openings: an extended source, patch by patch of the sky.

Of a few large elements the response to light from every direction is tabulated once and summed
over the Earth in view. On pixels the irradiance is the integral over the openings, seen from
points of a coarse grid: behind an opening of a millimetre or less it changes smoothly.

Light is ray-optical here: an Earth tens of degrees wide smooths what diffraction would do over a
few tens of micrometres. Only its limb is sharp; there an error of the edge's width remains, of
light that is a few thousandths of the Sun's to begin with.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import digest_of, memory
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction_tables import landing_points, layers
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene

#: Directions of the sky: Gauss nodes in the cosine of the incidence, equal steps in azimuth.
#: Against six times as many the response of the standard sensors changes by less than 0.7 % of
#: its largest value over random Earths, 0.07 % root mean square.
RINGS, SPOKES = 64, 192
#: Rays through all openings of a window together, about, and through each kind of slit.
_RAYS, _RAYS_A_SLIT = 64, 64
#: Steps between points along each axis of a window at most, along a linear array, and along the
#: line on which one slit of several alike is worked out. Against twice as many and 16 to 25 times
#: the rays, frames and profiles of the standard sensors change by less than 1 % of their largest
#: value, root mean square; more in single pixels where the limb's shadow is.
_MOST, _ALONG, _ALONG_A_SLIT = 16, 64, 128
#: Steps of the table over distances from an opening; it ends at this incidence.
_STEPS, _WIDEST_DEG = 2048, 85.0


@dataclass(frozen=True)
class EarthInView:
    """The Earth as N samples see it: nadir, and the Sun that lights it, (N, 3), sensor frame."""

    earth: Earth
    nadir: Floats
    sun: Floats

    def head(self, assembly: Assembly, order: Sequence[int] = (0, 1, 2)) -> tuple[Floats, Floats]:
        """Nadir and Sun as a head sees them, components in another order."""
        turned = (assembly.to_head(one)[:, list(order)] for one in (self.nadir, self.sun))
        nadir, sun = (np.ascontiguousarray(one) for one in turned)
        return nadir, sun


@dataclass(frozen=True)
class Points:
    """A grid on the detector: (N, 2) places of the first point, steps along x and y, and counts."""

    first_mm: Floats
    steps_mm: tuple[float, float]
    rows: int
    columns: int


@lru_cache(maxsize=4)
def sky(rings: int = RINGS, spokes: int = SPOKES) -> tuple[Floats, Floats]:
    """(J, 3) directions over the hemisphere in front, and (J,) their solid angles."""
    nodes, shares = np.polynomial.legendre.leggauss(rings)
    cosines = (nodes + 1.0) / 2.0
    directions, angles = [], []
    for ring, (cosine, share) in enumerate(zip(cosines, shares, strict=True)):
        sine = math.sqrt(1.0 - cosine * cosine)
        for step in range(spokes):
            # rings turned against each other: an edge along a meridian meets them anywhere
            turn = 2.0 * math.pi * (step + (ring * 0.618034) % 1.0) / spokes
            directions.append((sine * math.cos(turn), sine * math.sin(turn), cosine))
            angles.append(share * math.pi / spokes)
    found, solid = np.array(directions), np.array(angles)
    found.flags.writeable = solid.flags.writeable = False
    return found, solid


def upright_camera(camera: Camera) -> Camera:
    """Return the camera in its head's own frame, and a point for a Sun."""
    built = camera.assembly
    straight = Assembly(
        focal_length_error_mm=built.focal_length_error_mm,
        offset_x_mm=built.offset_x_mm,
        offset_y_mm=built.offset_y_mm,
    )
    return replace(camera, assembly=straight, sun=replace(camera.sun, diameter_deg=0.0))


def on_elements(
    camera: Camera,
    lit: Callable[[Camera, Scene], Floats],
    view: EarthInView,
    named_by: Hashable,
    nodes: tuple[int, int] = (RINGS, SPOKES),
) -> Floats:
    """(N, K) response of elements behind a mask to the Earth, in the units of `lit`.

    Parameters
    ----------
    camera
        Of the sensor.
    lit
        (J, K) response of the sensor with another camera to a scene.
    view
        What is seen.
    named_by
        All that `lit` depends on.
    nodes
        Rings and spokes of the sky.
    """
    from benchmark.simulator.kernels.earth import gather  # noqa: PLC0415 - Numba on demand

    directions, solid = sky(*nodes)
    count = len(directions)
    whole = Scene(directions, np.ones(count), np.zeros(count))
    # splits see the same sky
    response = memory.render(
        ("on_elements", named_by, nodes), lambda: lit(upright_camera(camera), whole)
    )

    def gathered() -> Floats:
        seen = response.any(axis=1)
        weights = np.ascontiguousarray((response * solid[:, None])[seen])
        out = np.empty((len(view.nadir), response.shape[1]))
        sources = np.ascontiguousarray(directions[seen]), weights
        gather(out, sources, view.head(camera.assembly), view.earth.tables())
        return out

    earth = view.earth, digest_of(view.nadir, view.sun)
    return memory.render(("on_elements", named_by, nodes, *earth), gathered)


def on_points(
    camera: Camera, points: Points, view: EarthInView, rays: int, *, swapped: bool = False
) -> Floats:
    """(N, R, C) irradiance from the Earth on a grid of the detector, units of normal sunlight.

    Parameters
    ----------
    camera
        Of the sensor.
    points
        Where.
    view
        What is seen.
    rays
        Through all openings together, at least one each.
    swapped
        Whether x and y of the mask and the grid are the sensor's y and x.
    """
    grid = points.steps_mm, points.rows, points.columns, rays, swapped
    seen = digest_of(points.first_mm, view.nadir, view.sun)
    # splits and conditions see the same Earth
    return memory.render(
        ("on_points", camera, grid, view.earth, seen),
        lambda: _on_points(camera, points, view, rays, swapped=swapped),
    )


def _on_points(
    camera: Camera, points: Points, view: EarthInView, rays: int, *, swapped: bool
) -> Floats:
    from benchmark.simulator.kernels.earth import behind_mask  # noqa: PLC0415 - Numba on demand

    assembly, mask = camera.assembly, camera.mask
    order = (1, 0, 2) if swapped else (0, 1, 2)
    numbers, waves = view.earth.tables()
    offset = np.array([assembly.offset_x_mm, assembly.offset_y_mm])[list(order[:2])]
    table, step = _landings(camera)
    out = np.empty((len(view.nadir), points.rows, points.columns))
    behind_mask(
        out,
        (
            np.ascontiguousarray(points.first_mm - offset),
            np.array(points.steps_mm),
        ),
        (_rays(mask.apertures, rays), table, step, mask.thickness_mm),
        view.head(assembly, order),
        (numbers, np.ascontiguousarray(waves[:, [*order, 3]])),
    )
    return out


def on_window(
    camera: Camera,
    first_mm: Floats,
    reach_mm: tuple[float, float],
    view: EarthInView,
) -> Floats:
    """(N, R, C) irradiance from the Earth at points evenly over windows of pixels.

    Their distance is about a quarter of the smallest opening, and at least a 16th of the window.

    Parameters
    ----------
    camera, view
        As of `on_points`.
    first_mm
        (N, 2) place of the first pixel's centre.
    reach_mm
        From there to the last one's, along x and y.
    """
    smallest = min(aperture.smallest_half_width_mm for aperture in camera.mask.apertures)
    steps = [min(max(math.ceil(2.0 * reach / smallest), 1), _MOST) for reach in reach_mm]
    apart = reach_mm[0] / steps[0], reach_mm[1] / steps[1]
    points = Points(first_mm, apart, 1 + steps[1], 1 + steps[0])
    return on_points(camera, points, view, _RAYS)


def on_array(
    camera: Camera, reach_mm: float, view: EarthInView, *, swapped: bool = False
) -> Floats:
    """(N, C) irradiance from the Earth at points evenly along a linear array behind slits.

    Slits of one size and slant differ in their places alone: what one of them lets through is
    worked out along a line that is longer by all their places, and taken from it for each.

    Parameters
    ----------
    camera, view, swapped
        As of `on_points`.
    reach_mm
        From the first pixel's centre to the last one's, symmetric about the detector's middle.
    """
    alike: dict[Aperture, list[float]] = {}
    for slit in camera.mask.apertures:
        alike.setdefault(replace(slit, x_mm=0.0), []).append(slit.x_mm)
    at = reach_mm * (np.arange(_ALONG + 1) / _ALONG - 0.5)
    total = np.zeros((len(view.nadir), len(at)))
    for slit, places in alike.items():
        steps = _ALONG if len(places) == 1 else _ALONG_A_SLIT
        low = -reach_mm / 2.0 - max(places)
        step = (reach_mm + max(places) - min(places)) / steps
        points = Points(np.tile([low, 0.0], (len(total), 1)), (step, 0.0), 1, steps + 1)
        alone = replace(camera, mask=replace(camera.mask, apertures=(slit,)))
        light = on_points(alone, points, view, _RAYS_A_SLIT, swapped=swapped)[:, 0]
        for place in places:
            along = np.clip((at - place - low) / step, 0.0, steps)
            node = np.minimum(along.astype(np.int64), steps - 1)
            part = along - node
            total += light[:, node] * (1.0 - part) + light[:, node + 1] * part
    return total


def add_between(light: Floats, nodes: Floats) -> None:
    """Add to frames (N, H, W) what lies between the points (N, R, C) of `on_window`, in place."""
    from benchmark.simulator.kernels.earth import add_between as add  # noqa: PLC0415 - Numba on demand

    add(light, np.ascontiguousarray(nodes))


@lru_cache(maxsize=32)
def _landings(camera: Camera) -> tuple[Floats, float]:
    """(T, 2) sine of the incidence and light a square millimetre of opening gives; and the step.

    Over equally spaced distances from the opening's foot. Light from a patch of the sky of
    solid angle ``ds_x ds_y / s_z``, falling at a cosine ``s_z``, spreads over ``J_r J_t ds_x ds_y``
    of the detector: a unit of radiance gives ``1 / (J_r J_t)``, without glass
    ``cos(theta)^4 / h^2``.
    """
    stack = layers(camera.height_mm, camera.glass)
    fine = np.array(
        [math.sin(math.radians(_WIDEST_DEG * n / (4 * _STEPS))) for n in range(4 * _STEPS + 1)]
    )
    landed = landing_points(fine, stack)
    step = float(landed[-1, 0]) / _STEPS
    sine = np.interp(step * np.arange(_STEPS + 1), landed[:, 0], fine)
    spread = landing_points(sine, stack)
    cosine = np.sqrt(1.0 - sine**2)
    rays = np.column_stack([sine, np.zeros(len(sine)), cosine])
    light = camera.glass.transmission(rays) / (spread[:, 1] * spread[:, 2])
    return np.column_stack([sine, light]), step


@lru_cache(maxsize=32)
def _rays(apertures: tuple[Aperture, ...], rays: int) -> Floats:
    """(Q, 8) points of all openings, as `behind_mask` wants them."""
    each = max(rays // len(apertures), 1)
    rows = []
    for a in apertures:
        c, s = math.cos(math.radians(a.rotation_deg)), math.sin(math.radians(a.rotation_deg))
        kind = 0.0 if a.shape == "round" else 1.0
        points = _spread(a, each)
        for u, v in points:
            place = a.x_mm + c * u - s * v, a.y_mm + s * u + c * v
            area = a.area_mm2 / len(points)
            rows.append((*place, area, kind, a.width_mm / 2.0, a.height_mm / 2.0, c, s))
    return np.array(rows)


def _spread(aperture: Aperture, count: int) -> list[tuple[float, float]]:
    """About `count` points of an opening, each for an equal share of its area."""
    a, b = aperture.width_mm / 2.0, aperture.height_mm / 2.0
    if aperture.shape == "round":
        golden = math.pi * (3.0 - math.sqrt(5.0))
        if count == 1:
            return [(0.0, 0.0)]
        radii = [a * math.sqrt((n + 0.5) / count) for n in range(count)]
        return [(r * math.cos(n * golden), r * math.sin(n * golden)) for n, r in enumerate(radii)]
    wide = max(round(math.sqrt(count * a / b)), 1)
    tall = max(count // wide, 1)
    return [
        (a * ((2 * i + 1) / wide - 1.0), b * ((2 * j + 1) / tall - 1.0))
        for j in range(tall)
        for i in range(wide)
    ]
