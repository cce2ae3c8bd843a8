"""What holds pipelines back: perfect parts are what physics says, and so is what they change."""

import dataclasses

import numpy as np
import pytest

from algorithms.contract import FeatureKind
from algorithms.models.geometric.pinhole import BuiltPinhole
from benchmark import datasets
from benchmark.datasets.corrected import correction
from benchmark.error_budget import perfected
from benchmark.error_budget.measure import directions, score_variants
from benchmark.error_budget.variants import SINGLE, VARIANTS
from benchmark.metrics.separation import separation_deg
from benchmark.plan.parts import installed_parts
from benchmark.running.stages import Task
from benchmark.running.task import measure
from benchmark.simulator.readout.references import References

#: Quick data sets of currents, of a dial, of profiles, of frequencies.
QUICK = (
    *("qpd-single-aperture", "psd-single-aperture", "pd-code-dial", "ccd-slit"),
    "ltf-maskless-cube",
)


def _first(name):
    preset = datasets.get(name)
    return preset, preset.conditions[0]


def test_a_unit_without_fixed_pattern_is_like_any_other():
    for name in datasets.names():
        preset, condition = _first(name)
        even = perfected.without_fixed_pattern(preset, condition)
        sensor = even.condition(condition).sensor
        one, other = sensor.fixed_pattern("one"), sensor.fixed_pattern("other")
        assert one.keys() == other.keys()
        for part, drawn in one.items():
            np.testing.assert_array_equal(drawn, other[part], err_msg=f"{name}: {part}")


@pytest.mark.parametrize("name", QUICK)
def test_a_still_reading_is_the_mean_of_what_the_sensor_reads(name):
    preset, condition = _first(name)
    setup = preset.condition(condition)
    read = perfected.still_observations(preset, condition, "test")
    scene = preset.scene(condition, "test")
    scene = dataclasses.replace(scene, stray=np.full(len(scene), setup.irradiance.stray))
    mean = setup.sensor.expected(scene, preset.fixed_pattern(condition))
    step = 1.0 if name == "ccd-slit" else 1e-4 * np.abs(mean).max()  # digital numbers stay whole
    assert read.shape == mean.shape
    assert np.abs(read - mean).max() <= 0.5 * step + 1e-9


def test_still_readings_are_the_same_every_time_and_noisy_ones_spread_around_them():
    preset, condition = _first("qpd-single-aperture")
    still = perfected.still_observations(preset, condition, "calibration")
    np.testing.assert_array_equal(
        still, perfected.still_observations(preset, condition, "calibration")
    )
    noisy = preset.generate(condition, "calibration").observations
    sensor = preset.condition(condition).sensor
    variance = sensor.variance(still)
    # stray light spreads them beside the noise, all four alike: differences of two are free of it
    apart = (noisy - still)[:, :2] @ [1.0, -1.0]
    assert np.mean(apart**2 / variance[:, :2].sum(axis=1)) == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize("name", ["ccd-slit", "pda-slit"])
def test_true_places_are_a_projection_of_the_directions(name):
    preset, condition = _first(name)
    sun = preset.scene(condition, "test").sun
    found = np.zeros((len(sun), 2))
    places = perfected.true_features(preset, condition, FeatureKind.SPOT, sun, found)
    design = preset.geometry_for(condition)
    model = BuiltPinhole.for_sensor(design, FeatureKind.SPOT)
    glass = preset.condition(condition).sensor.camera.glass.thickness_mm
    answers = model.fit(places, sun).predict(places)
    error = separation_deg(answers, sun).max()
    assert error < 1e-9 if glass == 0 else error > 1e-4  # refraction bends a projection


def test_currents_and_balances_have_no_places():
    preset, condition = _first("qpd-single-aperture")
    sun = preset.scene(condition, "test").sun
    found = np.zeros((len(sun), 2))
    assert perfected.true_features(preset, condition, FeatureKind.BALANCE, sun, found) is None


def test_spots_of_a_list_go_to_where_their_apertures_cast_light_and_others_stay():
    preset, condition = _first("cmos-encoded")
    drawn = perfected.without_fixed_pattern(preset, condition)
    geometry = preset.geometry_for(condition)
    sun = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    hole = np.array(geometry.apertures)[0, :2] / geometry.pixel_pitch_mm
    camera = drawn.condition(condition).sensor.camera
    true = hole + camera.spot_mm(sun[:1])[0] / geometry.pixel_pitch_mm + geometry.centre_px
    found = np.array([[*(true + 0.4), 9.0, -9999.0, -9999.0, 1.0], [np.nan] * 6])
    moved = perfected.true_features(drawn, condition, FeatureKind.SPOTS, sun, found)
    np.testing.assert_allclose(moved[0], [*true, 9.0, -9999.0, -9999.0, 1.0], atol=1e-9)
    assert np.isnan(moved[1]).all()


def test_what_is_not_there_is_not_made_perfect():
    ground, orbit = datasets.get("qpd-single-aperture"), datasets.get("pd-orbit")
    assert perfected.without_surroundings(ground, "nominal") is None
    assert perfected.without_lamp_errors(orbit, "nominal") is None
    calm = perfected.without_surroundings(orbit, "nominal").condition("nominal")
    assert calm.earth is None
    assert calm.sensor.drift == type(calm.sensor.drift)()


def test_a_perfect_bench_says_where_the_sun_stands_and_shines_evenly():
    preset, condition = _first("ccd-slit")
    perfect = perfected.perfect(preset, condition)
    taken = perfect.generate(condition, "calibration", 30)
    assert separation_deg(taken.sun, taken.truth).max() < 1e-12
    np.testing.assert_allclose(perfect.scene(condition, "calibration").irradiance, 1.0, atol=1e-15)
    lamp = perfected.without_lamp_errors(preset, condition)
    np.testing.assert_array_equal(
        lamp.generate(condition, "calibration", 9).sun,
        preset.generate(condition, "calibration", 9).sun,
    )


@pytest.fixture(scope="module")
def quadrant():
    """The polynomial behind a quadrant: errors of every variant, beside the runner's score."""
    parts = installed_parts()
    preset, condition = _first("qpd-single-aperture")
    extractor, model = parts.extractor("voltage-balance"), parts.model("polynomial-2d")
    found = score_variants(preset, condition, extractor, model, all_observable=True)
    (outcome,) = measure(Task(preset, condition, extractor, (model,))).outcomes
    return found, outcome.score


@pytest.mark.slow
def test_as_it_is_the_chain_errs_as_the_runner_says(quadrant):
    found, score = quadrant
    assert found.judged == 400
    assert found.errors_deg["as_is"] == pytest.approx(score.rms_deg, rel=1e-9)


@pytest.mark.slow
def test_benches_add_their_own_error_once(quadrant):
    errors = quadrant[0].errors_deg
    added = np.sqrt(errors["bench"] ** 2 - errors["as_is"] ** 2)
    # two drawn benches: their error is within a factor of two of what is expected of many
    expected = datasets.get("qpd-single-aperture").reference_error_deg("nominal")
    assert 0.5 < added / expected < 2.0


@pytest.mark.parametrize("name", ["ccd-slit", "qpd-single-aperture"])
def test_a_known_unit_is_what_many_references_tell(name):
    preset, condition = _first(name)
    exact = perfected.known_unit(preset, condition)
    often = dataclasses.replace(preset, offered=References(flats=4000, darks=4000))
    many, few = correction(often, condition), correction(preset, condition)
    for part in ("dark", "gain"):
        off = np.std(getattr(many, part) - getattr(exact, part))
        assert off <= 0.2 * np.std(getattr(few, part) - getattr(exact, part))


def test_events_and_lenses_have_no_references_to_know():
    preset, condition = _first("event-single-aperture")
    assert perfected.known_unit(preset, condition) is None


def test_a_perfect_part_never_makes_it_worse_beyond_chance(quadrant):
    found, _ = quadrant
    errors = found.errors_deg
    assert errors.keys() == set(VARIANTS)
    chance = 1.0 + 3.0 / np.sqrt(2 * found.judged)
    measured = [errors[name] for name in SINGLE if errors[name] is not None]
    assert len(measured) == 5  # there is nothing of an orbit
    assert max(errors["bench"], errors["uncorrected"]) > 0.99 * errors["as_is"]
    assert max(measured) < chance * errors["as_is"]
    assert errors["perfect"] < min(measured)
    assert errors["perfect_dense"] < chance * errors["perfect"]


def test_what_is_left_over_the_field_is_what_the_variants_err_by(quadrant):
    parts = installed_parts()
    preset, condition = _first("qpd-single-aperture")
    sun, answers = directions(
        preset, condition, parts.extractor("voltage-balance"), parts.model("polynomial-2d")
    )
    for name, given in answers.items():
        rms = np.sqrt(np.nanmean(separation_deg(given, sun) ** 2))
        assert rms == pytest.approx(quadrant[0].errors_deg[name], rel=1e-9)


@pytest.mark.slow
def test_a_geometric_model_inverts_the_true_places_of_its_sensor():
    parts = installed_parts()
    preset, condition = _first("ccd-slit")
    found = score_variants(
        preset,
        condition,
        parts.extractor("eigen-analysis"),
        parts.model("slit"),
        all_observable=True,
    )
    assert found.errors_deg["places"] < 1e-9
    assert found.errors_deg["as_is"] < 0.9 * found.errors_deg["uncorrected"]
    assert found.errors_deg["as_is"] < 0.5 * found.errors_deg["bench"]
    assert found.errors_deg["perfect"] < found.errors_deg["references"]
