"""What `make bench` times agrees with its references; its verdicts. Nothing is timed here."""

import json

import numpy as np
import pytest

from benchmark import datasets
from tools.bench import growth, startup
from tools.bench import simulator as speed
from tools.bench.comparing import Subject
from tools.bench.light import diffracted_frames, light_of_frames
from tools.bench.references import (
    centroid_of_spots,
    counted_light,
    rendering_of_frames,
    shadows_of,
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "prepare", [centroid_of_spots, rendering_of_frames, light_of_frames, diffracted_frames]
)
def test_what_is_timed_gives_the_result_of_its_reference(prepare):
    subject = Subject(**prepare())
    assert subject.worst <= subject.tolerance, subject


def test_the_counted_light_is_an_oracle_for_the_total_of_a_frame():
    """Light through a hole: area times cosine, less what the foil's thickness shades."""
    preset = datasets.get("cmos-single-aperture")
    sensor = preset.condition("nominal").sensor
    scene = preset.scene("nominal", "test").part(0, 3)
    counted, exact = counted_light(sensor, scene), shadows_of(sensor).lit(scene)
    np.testing.assert_allclose(counted.sum(axis=(1, 2)), exact.sum(axis=(1, 2)), rtol=2e-3)
    most = sensor.camera.mask.apertures[0].area_mm2 / sensor.detector.pitch_mm**2
    assert (counted.sum(axis=(1, 2)) <= most * scene.irradiance).all()


def subject(ratio, worst):
    """A subject that takes `ratio` times its reference's time, by a clock of its own."""
    now = [0.0]

    def spend(seconds):
        now[0] += seconds

    return Subject(
        "s",
        "r",
        call=lambda: spend(10 * ratio),
        reference=lambda: spend(1.0),
        items=10,
        reference_items=1,
        limit=0.5,
        worst=worst,
        tolerance=1e-3,
        clock=lambda: now[0],
    )


@pytest.mark.parametrize(
    ("ratio", "worst", "status"), [(0.1, 0.0, 0), (3.0, 0.0, 1), (0.1, 0.1, 1)]
)
@pytest.mark.parametrize("form", ["table", "json"])
def test_a_broken_limit_or_another_result_is_the_exit_status(
    monkeypatch, capsys, *, ratio, worst, status, form
):
    monkeypatch.setattr(speed, "subjects", lambda: [subject(ratio, worst)])
    assert speed.main(["--format", form, "--repeats", "3"]) == status
    out = capsys.readouterr().out
    if form == "json":
        [found] = json.loads(out)["comparisons"]
        assert found["passes"] is (status == 0)
        assert found["agrees"] is (worst == 0)
        assert found["ratio"] == pytest.approx(ratio)
        assert found["reference_best_us"] == pytest.approx(1e6)
    else:
        assert ("BROKEN" in out) is (ratio > 0.5)
        assert ("DISAGREES" in out) is (worst > 0)


def test_no_repeats_are_refused(capsys):
    with pytest.raises(SystemExit):
        speed.main(["--repeats", "0"])
    assert "1; got 0" in capsys.readouterr().err


def test_the_small_harness_prepares_what_runs():
    """Called once, not timed."""
    for prepared in startup.subjects():
        prepared.call()
        prepared.reference()
        before = prepared.clock()
        assert prepared.clock() >= before >= 0


def test_the_exponent_of_growth_is_the_slope_of_cost_over_work():
    linear = growth.Growth("run", "methods", (1, 2, 4), (10, 20, 40), (0.3, 0.6, 1.2))
    square = growth.Growth("run", "methods", (1, 2, 4), (10, 20, 40), (0.3, 1.2, 4.8))
    assert linear.exponent == pytest.approx(1.0)
    assert square.exponent == pytest.approx(2.0)


def test_made_up_parts_are_as_many_cells_as_asked_for():
    assert (
        growth.prepare_running(methods=2, datasets=3, units=2)[0]
        == 2 * growth.prepare_running(2, 3)[0]
    )
    assert growth.prepare_running(methods=4)[0] == 2 * growth.prepare_running(methods=2)[0]
    cells, run = growth.prepare_running(methods=2)
    run()
    assert cells > 0
