"""Error-free, noiseless profiles and code dials are inverted exactly; bounds scale as they must."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, periodic
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.code_dial import CodeDialSensor
from benchmark.simulator.sensors.line_sensor import LineSensor

GRID = np.array([-58.0, -41.3, -20.0, -0.7, 0.0, 3.1, 17.7, 35.2, 59.0])
POINT = SolarDisc(diameter_deg=0.0)


def ideal(name: str, **changes: Any) -> LineSensor:
    """The dataset's sensor without errors, thickness, glass or diffraction, under a point Sun."""
    sensor = datasets.get(name).setups["nominal"].sensor
    assert isinstance(sensor, LineSensor)
    camera = replace(
        sensor.camera,
        mask=changes.pop("mask", Mask(sensor.camera.mask.apertures)),
        sun=POINT,
        glass=changes.pop("glass", CoverGlass()),
        assembly=Assembly(),
    )
    # long slits: without glass the light is displaced further
    mask = camera.mask
    longer = tuple(replace(a, height_mm=1.2 * a.height_mm) for a in mask.apertures)
    camera = replace(camera, mask=replace(mask, apertures=longer))
    plain = {"errors": SlitErrors(), "fill_factor": 1.0, "spectrum": None}
    return replace(sensor, camera=camera, **{**plain, **changes})


def scene_over(half: float = 60.0) -> tuple[Scene, np.ndarray, np.ndarray]:
    inside = GRID[np.abs(GRID) < half]
    alpha, beta = (axis.ravel() for axis in np.meshgrid(inside, inside))
    sun = from_angles(alpha, beta)
    return Scene(sun, np.ones(len(sun)), np.zeros(len(sun))), alpha, beta


def edges_mm(sensor: LineSensor, scene: Scene) -> np.ndarray:
    """(N, axes, slits, 2) where every spot starts and ends, from the pixels it fills or not.

    A pixel of the spot's even middle splits it; what lies left of it, added up, is the way to its
    left edge (of a slanted slit: to the edge's middle), and so to the right.
    """
    detector, slits = sensor.detector, len(sensor.camera.mask.apertures)
    profiles = sensor.lit(scene).reshape(len(scene), len(sensor.axes), detector.columns)
    out = np.empty((len(scene), len(sensor.axes), slits, 2))
    for n, m in np.ndindex(out.shape[:2]):
        share = profiles[n, m] / profiles[n, m].max()
        lit = np.flatnonzero(share > 1e-9)
        spots = np.split(lit, np.flatnonzero(np.diff(lit) > 1) + 1)
        assert len(spots) == slits
        for k, spot in enumerate(spots):
            # the shadow of a slanted slit leans by more than its width: all pixels of its middle
            # are lit alike
            full = spot[np.argmax(share[spot])]
            left = share[spot[spot < full]].sum() / share[full]
            right = share[spot[spot >= full]].sum() / share[full]
            out[n, m, k] = full - left, full + right
    return (out - detector.columns / 2) * detector.pitch_mm


def centres_mm(sensor: LineSensor, scene: Scene) -> np.ndarray:
    return edges_mm(sensor, scene).mean(axis=3)


def degrees(tangent: np.ndarray) -> np.ndarray:
    return np.degrees(np.arctan(tangent))


@pytest.mark.parametrize("name", ["ccd-slit", "pda-slit", "ccd-periodic"])
def test_slits_give_one_angle_an_array(name: str) -> None:
    sensor = ideal(name)
    scene, alpha, beta = scene_over()
    places = np.array([a.x_mm for a in sensor.camera.mask.apertures])
    tangent = (centres_mm(sensor, scene) - places) / sensor.camera.focal_length_mm
    assert np.abs(degrees(tangent[:, 0]) - beta[:, None]).max() < 1e-6
    assert np.abs(degrees(tangent[:, 1]) - alpha[:, None]).max() < 1e-6


def test_slit_under_glass_is_inverted_by_snells_law() -> None:
    plates = datasets.get("ccd-slit").setups["glass"].sensor.camera.glass
    sensor = ideal("ccd-slit", glass=plates)
    scene, alpha, beta = scene_over()
    x, y = centres_mm(sensor, scene)[:, :, 0].T
    thickness, index = plates.plates[0].thickness_mm, plates.plates[0].index
    low, high = np.zeros(len(x)), np.full(len(x), math.pi / 2 - 1e-9)
    for _ in range(60):
        theta = (low + high) / 2
        inside = np.arcsin(np.sin(theta) / index)
        far = (3.5 - thickness) * np.tan(theta) + thickness * np.tan(inside) > np.hypot(x, y)
        low, high = np.where(far, low, theta), np.where(far, theta, high)
    turn = np.arctan2(y, x)
    assert np.abs(degrees(np.tan(low) * np.cos(turn)) - beta).max() < 1e-6
    assert np.abs(degrees(np.tan(low) * np.sin(turn)) - alpha).max() < 1e-6


def test_deflection_and_inclination_act_as_the_slit_model_says() -> None:
    """eq:slit (KeQiang2020) along x: the survey's delta is minus ours, both angles' roles kept."""
    theta, delta = 2.0, 3.0
    sensor = ideal("ccd-slit", errors=SlitErrors(theta, delta))
    scene, alpha, beta = scene_over(40.0)
    a, b = np.tan(np.radians(beta)), np.tan(np.radians(alpha))
    t = math.tan(math.radians(-delta))
    # inclined slit: arctan(a t / (1 - b t)) is the direction of its shadow
    shadow = np.arctan(a * t / (1 - b * t))
    model = a + b * np.tan(shadow)
    found = centres_mm(replace(sensor, errors=SlitErrors(0.0, delta)), scene)[:, 0, 0] / 3.5
    assert np.abs(degrees(found) - degrees(model)).max() < 1e-6
    # deflected slit: the shadow is turned by the deflection
    found = centres_mm(replace(sensor, errors=SlitErrors(theta, 0.0)), scene)[:, :, 0] / 3.5
    turn = math.tan(math.radians(theta))
    assert np.abs(found[:, 0] - (a + b * turn)).max() < 1e-9
    assert np.abs(found[:, 1] - (b - a * turn)).max() < 1e-9


def test_n_slit_is_inverted_by_the_n_slit_model() -> None:
    """eq:nslit1 and eq:nslit2 (Maji2015), no refraction: K = 1."""
    sensor = ideal("ccd-n-slit")
    scene, alpha, beta = scene_over()
    noon = Scene(np.array([[0.0, 0.0, 1.0]]), np.ones(1), np.zeros(1))
    left, middle, right = (centres_mm(sensor, scene) - centres_mm(sensor, noon))[:, 0].T
    h, slant = 1.8, math.tan(math.radians(45.0))
    assert np.abs(degrees(middle / h) - alpha).max() < 1e-6
    tangent = (left + right) / (2 * h * slant) - middle / (h * slant)
    assert np.abs(degrees(tangent) - beta).max() < 1e-6


def test_v_slit_is_inverted_exactly() -> None:
    """model:vslit without structural errors: the square slit gives alpha, the slanted both."""
    sensor = ideal("ccd-v-slit")
    scene, alpha, beta = scene_over()
    square, slanted = centres_mm(sensor, scene)[:, 0].T
    tangent = (square + 3.3) / 1.8
    assert np.abs(degrees(tangent) - alpha).max() < 1e-6
    assert np.abs(degrees((slanted - 0.5) / 1.8 - tangent) - beta).max() < 1e-6


def test_vernier_is_inverted_by_the_borders_that_cross_its_slits() -> None:
    """Light left of a pixel border counts whole slits and a share of the one the border crosses.

    Slits 3.2 pixels apart are crossed by a border each in its own place; every crossed one gives
    the displacement, and which it is, missing ones included, follows from the count.
    """
    sensor = ideal("ccd-vernier")
    scene, alpha, beta = scene_over(64.0)
    pitch = sensor.detector.pitch_mm
    slits = sorted(sensor.camera.mask.apertures, key=lambda a: a.x_mm)
    assert len(slits) == 14
    width = slits[0].width_mm / pitch
    left = np.array([a.x_mm / pitch for a in slits]) - width / 2
    profiles = sensor.lit(scene).reshape(len(scene), 2, sensor.detector.columns)
    for n, axis in np.ndindex(profiles.shape[:2]):
        before = np.concatenate([[0.0], np.cumsum(profiles[n, axis])])
        counted = before / before[-1] * len(slits)
        number = np.floor(counted).astype(int)
        crossed = np.flatnonzero((counted - number > 1e-6) & (counted - number < 1 - 1e-6))
        assert len(crossed) > len(slits)  # a slit is wider than a pixel
        start = crossed - (counted - number)[crossed] * width - sensor.detector.columns / 2
        tangent = (start - left[number[crossed]]) * pitch / sensor.camera.focal_length_mm
        angle = (beta, alpha)[axis][n]
        assert np.abs(degrees(tangent) - angle).max() < 1e-6


def test_crossed_pairs_give_sum_and_difference_of_the_tangents() -> None:
    sensor = ideal("ccd-multi-slit")
    scene, alpha, beta = scene_over()
    falling, rising = centres_mm(sensor, scene)[:, 0].reshape(-1, 2, 2).mean(axis=2).T
    less, more = (falling + 4.6) / 1.8, (rising - 4.6) / 1.8
    assert np.abs(degrees((more + less) / 2) - beta).max() < 1e-6
    assert np.abs(degrees((more - less) / 2) - alpha).max() < 1e-6


def test_five_slits_are_inverted_edge_by_edge() -> None:
    """eq:mslit1, eq:mslit2 (Bolshakov2020): one edge is the rim at h, the other that at h + t."""
    preset = datasets.get("pda-multi-slit")
    mask = preset.setups["nominal"].sensor.camera.mask
    sensor = ideal("pda-multi-slit", mask=mask)
    assert sensor.camera.mask.thickness_mm == 0.05
    scene, alpha, beta = scene_over(51.5)
    low = sensor.camera.focal_length_mm - mask.thickness_mm / 2
    high = low + mask.thickness_mm
    edges = edges_mm(sensor, scene)
    for axis, angle in enumerate((beta, alpha)):
        sign = np.where(angle >= 0, 1.0, -1.0)[:, None]
        for k, aperture in enumerate(mask.apertures):
            moved = edges[:, axis, k] - aperture.x_mm - np.array([-0.1, 0.1])
            # the light's trailing edge is the upper rim's, its leading edge the lower rim's
            heights = np.where(sign > 0, [high, low], [low, high])
            assert np.abs(degrees(moved / heights) - angle[:, None]).max() < 1e-6


def ideal_dial(**changes: Any) -> CodeDialSensor:
    sensor = datasets.get("pd-code-dial").setups["nominal"].sensor
    assert isinstance(sensor, CodeDialSensor)
    camera = replace(
        sensor.camera,
        mask=Mask(sensor.camera.mask.apertures),
        sun=changes.pop("sun", POINT),
        assembly=Assembly(),
    )
    dial = replace(sensor.dial, track_error_mm=0.0, **changes)
    readout = replace(sensor.readout, gain_mismatch=0.0, dark=DarkCurrent(0.0))
    return replace(
        sensor, camera=camera, dial=dial, readout=readout, deflection_deg=0.0, spectrum=None
    )


def dial_parts(sensor: CodeDialSensor, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Coarse (N, axes, bits) and fine (N, axes, 4) currents."""
    currents = sensor.expected(scene, sensor.fixed_pattern("test"))
    currents = currents.reshape(len(scene), 2, sensor.dial.tracks)
    return currents[..., : sensor.dial.bits], currents[..., sensor.dial.bits :]


def test_code_dial_is_inverted_by_cell_and_phase() -> None:
    sensor = ideal_dial()
    dial = sensor.dial
    scene, alpha, beta = scene_over()
    coarse, fine = dial_parts(sensor, scene)
    # F1 + F3 is what an open track shows
    bits = coarse > ((fine[..., 0] + fine[..., 2]) / 2)[..., None]
    number = np.zeros(bits.shape[:2], dtype=int)
    last = np.zeros(bits.shape[:2], dtype=int)
    for bit in range(dial.bits):
        last ^= bits[..., bit]
        number = 2 * number + last
    rough = (number + 0.5) * dial.cell_mm - dial.reach_mm
    phase = np.arctan2(fine[..., 3] - fine[..., 1], fine[..., 2] - fine[..., 0])
    exact = phase / (2 * math.pi) * dial.period_mm
    place = exact + dial.period_mm * np.rint((rough - exact) / dial.period_mm)
    angle = degrees(place / sensor.camera.focal_length_mm)
    assert np.abs(angle[:, 0] - beta).max() < 1e-6
    assert np.abs(angle[:, 1] - alpha).max() < 1e-6


def phases(sensor: CodeDialSensor, shifts: tuple[float, ...] = (0, 0, 0, 0)) -> tuple[Any, Any]:
    """True phase and fine currents in units of the open track over one period along x."""
    dial = sensor.dial
    true = (np.arange(64) + 0.5) / 64 * 2 * math.pi
    beta = degrees(true / (2 * math.pi) * dial.period_mm / sensor.camera.focal_length_mm)
    sun = from_angles(np.zeros(64), beta)
    pattern = dict(sensor.fixed_pattern("test"))
    pattern["shift_mm"] = np.tile([0.0] * dial.bits + list(shifts), 2)
    scene = Scene(sun, 1 / sun[:, 2], np.zeros(64))
    return true, sensor.lit(scene, pattern)[:, dial.bits : dial.tracks]


def test_square_windows_give_the_fourier_series_of_a_triangle() -> None:
    """eq:fourier: slit and windows of half a period each make a_n = 4/(pi n)^2, n odd."""
    true, rows = phases(ideal_dial(fine_rows="square"))
    for number, row in enumerate(rows.T):
        turned = true - number * math.pi / 2  # each row is the first, a quarter period on
        series = sum(4 / (math.pi * n) ** 2 * np.cos(n * turned) for n in range(1, 4001, 2))
        assert row == pytest.approx(0.5 - series, abs=1e-4)


def test_a_displaced_row_pair_errs_twice_a_period() -> None:
    """eq:pamulti: the phase error of the fine code is k sin(2 p + t), p the fine phase."""
    sensor = ideal_dial()
    skew = 0.02
    away = skew / (2 * math.pi) * sensor.dial.period_mm
    true, rows = phases(sensor, (0, away, 0, away))
    phase = np.arctan2(rows[:, 3] - rows[:, 1], rows[:, 2] - rows[:, 0])
    error = np.angle(np.exp(1j * (phase - true)))
    spectrum = np.abs(np.fft.rfft(error - error.mean())) / 32
    assert spectrum.argmax() == 2
    assert spectrum[2] == pytest.approx(skew / 2, rel=0.02)


def test_disc_and_slit_lower_the_contrast_as_their_transforms_say() -> None:
    """Slit: sinc(w/p); disc: the transform of its limb-darkened marginal, by quadrature."""
    sensor = ideal_dial(sun=SolarDisc())
    _, rows = phases(sensor)
    contrast = np.hypot(rows[:, 3] - rows[:, 1], rows[:, 2] - rows[:, 0])
    x = np.linspace(-1, 1, 20001)
    u = 0.6
    chord = np.sqrt(1 - x**2)
    marginal = 2 * (1 - u) * chord + u * math.pi / 2 * chord**2
    reach = 2.5 * math.tan(math.radians(0.2665))
    disc = (marginal * np.cos(2 * math.pi * x * reach / 0.64)).sum() / marginal.sum()
    assert contrast[0] == pytest.approx(2 / math.pi * disc, rel=1e-5)


def test_light_of_the_dial_is_conserved_over_the_field() -> None:
    """Complementary fine rows share all the slit's light, wherever it falls; ghosts add to it.

    What is thrown back twice adds at most its share: part of it falls beside the dial or leaves
    through the slit again.
    """
    for condition, setup in datasets.get("pd-code-dial").setups.items():
        sensor = setup.sensor
        assert isinstance(sensor, CodeDialSensor)
        camera = replace(sensor.camera, mask=Mask(sensor.camera.mask.apertures))
        dial = replace(sensor.dial, track_error_mm=0.0)
        whole = replace(sensor, camera=camera, dial=dial, deflection_deg=0.0, ghost=None)
        half = datasets.get("pd-code-dial").directions.half_fov_deg
        corners = np.array([-half, -half, half, half, 0.0])
        sun = from_angles(corners, np.array([-half, half, -half, half, 0.0]))
        scene, pattern = Scene(sun, np.ones(5), np.zeros(5)), whole.fixed_pattern("test")
        fine = whole.lit(scene, pattern).reshape(5, 2, -1)[..., -4:]
        twice = replace(whole, ghost=sensor.ghost).lit(scene, pattern).reshape(5, 2, -1)[..., -4:]
        share = 0.0 if sensor.ghost is None else sensor.ghost.share
        assert (share > 0.0) == (condition == "ghosts")
        head = camera.assembly.to_head(sun)
        light = camera.sun.directions(head)[..., 2] @ camera.sun.quadrature()[1]
        for pair in ((0, 2), (1, 3)):
            both = fine[..., pair[0]] + fine[..., pair[1]]
            assert both == pytest.approx(np.repeat(light[:, None], 2, 1), rel=1e-9), condition
            added = twice[..., pair[0]] + twice[..., pair[1]] - both
            assert (added >= -1e-12).all()
            assert (added <= share * light[:, None] + 1e-12).all()
            assert (added.max() > 0.0) == (share > 0.0)


def test_bound_of_a_reticle_falls_with_the_square_root_of_its_slits() -> None:
    """Tsuno2019 by the survey: N equal slits are N observations, accuracy goes with N^-1/2."""
    setup = datasets.get("ccd-periodic").setups["nominal"]
    sensor = setup.sensor
    assert isinstance(sensor, LineSensor)
    rng = np.random.default_rng(5)
    sun = from_angles(*(80 * rng.random((2, 60)) - 40))
    scene = Scene(sun, np.ones(60), np.full(60, setup.irradiance.stray))
    # what all slits share, stray light and the Sun's strength, as good as known
    light = Irradiance(spread=1e-7, stray=setup.irradiance.stray, stray_spread=1e-9)
    found = []
    for count in (1, 4, 16):
        mask = periodic(count, 0.4, 0.2, 7.6, 0.01)
        trial = replace(sensor, camera=replace(sensor.camera, mask=mask))
        found.append(cramer_rao(trial, scene, trial.fixed_pattern("test"), light).rms_deg)
    assert found[0] / found[1] == pytest.approx(2.0, rel=0.03)
    assert found[0] / found[2] == pytest.approx(4.0, rel=0.03)
