"""Mask layouts tell where the Sun is; manufacture changes them as specified."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmark.datasets.standard.cmos_compound_eye import PRESET as EYE
from benchmark.datasets.standard.cmos_encoded import PRESET as ENCODED
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.coded import compound_eye, spacing_coded
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.masks.layouts import grid, slit
from benchmark.simulator.scene import Scene


def places(mask: Mask) -> np.ndarray:
    return np.array([(a.x_mm, a.y_mm) for a in mask.apertures])


def spots_on_detector(preset, sun: np.ndarray) -> list[np.ndarray]:
    """Whole spots (n, 2) in mm from the detector's middle, of a perfect sensor, per direction."""
    sensor = preset.setups["nominal"].sensor
    h, mask = sensor.camera.focal_length_mm, sensor.camera.mask
    half = sensor.detector.columns * sensor.detector.pitch_mm / 2
    radius = np.array([a.width_mm / 2 for a in mask.apertures])
    found = []
    for s in sun:
        at = places(mask) + h * s[:2] / s[2]
        # half the Sun's image, at its longest
        blur = h * math.tan(math.radians(0.533 / 2)) / s[2] ** 2
        found.append(at[(np.abs(at).max(axis=1) + radius + blur) < half])
    return found


def test_a_grid_is_centred_and_regular() -> None:
    mask = grid(3, 2, 0.5, Aperture("round", 0.1, 0.1, 0.2, 0.0), 0.01)
    assert places(mask).mean(axis=0) == pytest.approx([0.2, 0.0])
    assert places(mask)[:3, 0] == pytest.approx([-0.3, 0.2, 0.7])
    assert mask.thickness_mm == 0.01
    with pytest.raises(ValueError, match=r"must exceed the aperture's 0\.1 mm"):
        grid(2, 1, 0.1, Aperture("round", 0.1, 0.1))
    with pytest.raises(ValueError, match="at least one column"):
        grid(0, 1, 0.5, Aperture("round", 0.1, 0.1))
    with pytest.raises(ValueError, match="longer than wide"):
        slit(0.5, 0.1)


def decoded_direction(spots: np.ndarray, step: float, first: float) -> np.ndarray | None:
    """Sub-field and direction from spots alone, by the drawing's rules."""
    h = ENCODED.geometry.focal_length_mm
    pitch = 2 * h * math.tan(math.radians(52.5)) / 13
    longest = first + 12.5 * step
    for corner in spots:
        away = spots - corner
        right = away[(np.abs(away[:, 1]) < 1e-3) & (away[:, 0] > 0) & (away[:, 0] < longest)]
        upper = away[(np.abs(away[:, 0]) < 1e-3) & (away[:, 1] > 0) & (away[:, 1] < longest)]
        if len(right) == len(upper) == 1:
            i = (right[0, 0] - first) / step
            j = (upper[0, 1] - first) / step
            assert abs(i - round(i)) < 0.01
            assert abs(j - round(j)) < 0.01
            back = (first + first + 12 * step) / 4
            group = (np.round([i, j]) - 6) * pitch - back
            tangent = (corner - np.round(group, 4)) / h
            return np.array([*tangent, 1.0]) / math.sqrt(1 + tangent @ tangent)
    return None


def test_spacings_name_the_sub_field_everywhere_in_the_field() -> None:
    """At any direction one whole group is seen; it gives the direction to below 1e-6 deg."""
    assert ENCODED.geometry.half_fov_deg >= 105 / 2
    assert ENCODED.geometry.subfields == 13
    assert len(ENCODED.geometry.apertures or ()) == 3 * 13**2
    rng = np.random.default_rng(3)
    angles = np.concatenate([rng.uniform(-52.5, 52.5, (400, 2)), [[52.5, 52.5], [-52.5, 0]]])
    sun = from_angles(angles[:, 0], angles[:, 1])
    for s, spots in zip(sun, spots_on_detector(ENCODED, sun), strict=True):
        found = decoded_direction(spots, 0.011, 0.46)
        assert found is not None
        assert math.degrees(np.linalg.norm(np.cross(found, s))) < 1e-6


def test_shadows_of_the_encoded_mask_never_touch() -> None:
    sensor = replace(ENCODED.setups["nominal"].sensor, spectrum=None)
    pattern = ENCODED.fixed_pattern("nominal")
    edge = np.array([-52.5, -30.0, 0.0, 30.0, 52.5])
    sun = from_angles(np.repeat(edge, 5), np.tile(edge, 5))
    boxes = sensor.boxes(Scene(sun, np.ones(25), np.zeros(25)), pattern)
    for mine in boxes:
        seen = mine[(mine[:, 1] > mine[:, 0]) & (mine[:, 3] > mine[:, 2])]
        assert len(seen) >= 3
        frame = np.zeros((256, 256), dtype=int)
        for left, right, top, bottom in seen:
            frame[top:bottom, left:right] += 1
        # boxes of round spots may share a rim of pixels at 60 deg, not more
        assert (frame > 1).sum() < 0.02 * (frame > 0).sum()


def test_codes_that_could_be_misread_are_refused() -> None:
    good = {"pitch_mm": 2.4, "diameter_mm": 0.5, "first_mm": 0.9, "step_mm": 0.02}
    assert len(spacing_coded(13, **good).apertures) == 507
    with pytest.raises(ValueError, match=r"ambiguous in cells of 2\.2 mm"):
        spacing_coded(13, **(good | {"pitch_mm": 2.2}))
    with pytest.raises(ValueError, match=r"0\.95"):
        spacing_coded(13, **(good | {"diameter_mm": 0.95}))


def test_the_compound_eye_has_the_published_counts_and_no_overlaps() -> None:
    mask = EYE.setups["nominal"].sensor.camera.mask
    at = places(mask)
    assert len(at) == 1026
    widths = np.array([a.width_mm for a in mask.apertures])
    assert len(set(widths)) > 3  # sizes vary from ring to ring of sub-eyes
    assert widths[0] == widths.min()
    apart = np.linalg.norm(at[:, None] - at[None], axis=2)
    np.fill_diagonal(apart, 9)
    assert (apart > (widths[:, None] + widths[None]) / 2).all()
    # round: every direction ends at about the same radius
    azimuth = np.arctan2(at[:, 1], at[:, 0])
    reach = [
        np.linalg.norm(at, axis=1)[np.abs(azimuth - a) < 0.3].max()
        for a in np.linspace(-2.8, 2.8, 9)
    ]
    assert np.ptp(reach) < 1.0
    with pytest.raises(ValueError, match=r"overlap.*0\.8"):
        compound_eye(100, 2, pitch_mm=0.8, diameter_mm=0.6, code_mm=0.1, focal_length_mm=5.0)


def test_the_compound_eye_is_recognised_wherever_it_is_seen() -> None:
    """The pattern on the detector fits one place of the mask, and no other nearly as well."""
    mask = places(EYE.setups["nominal"].sensor.camera.mask)
    tree = cKDTree(mask)
    rng = np.random.default_rng(8)
    z = 1 - (1 - math.cos(math.radians(60))) * rng.random(60)
    turn = 2 * math.pi * rng.random(60)
    sun = np.column_stack([*(np.sqrt(1 - z * z) * f(turn) for f in (np.cos, np.sin)), z])
    counts = Counter()
    for s, spots in zip(sun, spots_on_detector(EYE, sun), strict=True):
        counts[len(spots)] += 1
        noisy = spots + rng.normal(scale=0.0005, size=spots.shape)  # a twentieth of a pixel
        anchor = noisy[np.linalg.norm(noisy, axis=1).argmin()]
        moved = mask[:, None] + (noisy - anchor)[None]  # where spots would be in the mask
        away, _ = tree.query(moved)
        misfit = np.sqrt((away**2).mean(axis=1))
        best, second = np.argsort(misfit)[:2]
        true = np.linalg.norm(mask + 6.0 * s[:2] / s[2] - anchor, axis=1).argmin()
        assert best == true
        assert misfit[second] > 5 * misfit[best]
    assert min(counts) >= 3


def test_a_unit_keeps_its_errors_whatever_else_is_wrong_with_it() -> None:
    mask = grid(10, 10, 0.5, Aperture("rectangle", 0.2, 0.1, rotation_deg=30.0))
    drawn = mask.table()
    same, open_ = MaskErrors().built(mask, "unit")
    assert np.array_equal(same, drawn)
    assert (open_ == 1).all()
    placed, _ = MaskErrors(position_mm=0.003).built(mask, "unit")
    both, _ = MaskErrors(position_mm=0.003, size_mm=0.002, missing=0.2).built(mask, "unit")
    assert np.array_equal(placed[:, 1:3], both[:, 1:3])
    assert np.array_equal(placed[:, 3:], drawn[:, 3:])
    assert (placed[:, 1:3] - drawn[:, 1:3]).std() == pytest.approx(0.003, rel=0.2)
    grown = both[:, 3:5] - drawn[:, 3:5]
    assert np.ptp(grown) < 1e-15  # one over-etch for the whole unit
    other, _ = MaskErrors(position_mm=0.003).built(mask, "another")
    assert not np.allclose(other, placed)


def test_edges_move_by_themselves() -> None:
    edge = 0.001
    table, _ = MaskErrors(edge_mm=edge).built(
        grid(40, 40, 0.5, Aperture("rectangle", 0.2, 0.1, rotation_deg=30.0)), "unit"
    )
    drawn = grid(40, 40, 0.5, Aperture("rectangle", 0.2, 0.1, rotation_deg=30.0)).table()
    off, c, s = table[:, 1:3] - drawn[:, 1:3], math.cos(math.pi / 6), math.sin(math.pi / 6)
    for own, column in ((off @ [c, s], 3), (off @ [-s, c], 4)):
        wider = table[:, column] - drawn[:, column]
        sides = np.array([own + wider, own - wider])  # outer and inner edge's own moves
        assert sides.std(axis=1) == pytest.approx([edge, edge], rel=0.1)
        assert abs(np.corrcoef(sides)[0, 1]) < 0.1
    rounded, _ = MaskErrors(edge_mm=edge).built(grid(5, 5, 0.5, Aperture("round", 0.2, 0.2)), "u")
    assert np.array_equal(rounded[:, 3], rounded[:, 4])
    assert np.ptp(rounded[:, 3]) > 0
    turned, _ = MaskErrors(rotation_deg=0.5).built(
        grid(20, 20, 0.5, slit(0.1, 0.3).apertures[0]), "u"
    )
    assert np.degrees(np.arctan2(turned[:, 6], turned[:, 5])).std() == pytest.approx(0.5, rel=0.15)


def test_built_radii_are_off_by_the_stated_deviation() -> None:
    """Of many units with one hole each: the unit's common size and the hole's own edges."""
    errors = MaskErrors(position_mm=0.001, size_mm=0.002, edge_mm=0.0015)
    mask = Mask((Aperture("round", 0.1, 0.1),))
    radii = [errors.built(mask, "unit", n)[0][0, 3] for n in range(800)]
    assert np.mean(radii) == pytest.approx(0.05, abs=4.0 * errors.radius_mm / math.sqrt(800))
    assert np.std(radii) == pytest.approx(errors.radius_mm, rel=4.0 / math.sqrt(2.0 * 800))


def test_missing_and_dirty_apertures_are_exactly_as_many_as_told() -> None:
    mask = grid(10, 10, 0.5, Aperture("round", 0.2, 0.2))
    _, some = MaskErrors(missing=0.2, dirty=0.1).built(mask, "unit")
    assert (some == 0).sum() == 20
    dirty = some[(some > 0) & (some < 1)]
    assert len(dirty) == 10
    assert dirty.min() >= 0.2
    assert dirty.max() <= 0.8
    _, more = MaskErrors(missing=0.4).built(mask, "unit")
    assert set(np.flatnonzero(some == 0)) < set(np.flatnonzero(more == 0))
