"""Speed as ratios within one run, and the verdicts of `make bench`."""

import json

import numpy as np
import pytest

from benchmark import datasets
from tests.speed import simulator as speed
from tests.speed.light import diffracted_frames, light_of_frames
from tests.speed.references import centroid_of_spots, counted_light, rendering_of_frames


@pytest.fixture(scope="module")
def centroid():
    return speed.Subject(**centroid_of_spots())


@pytest.fixture(scope="module")
def rendering():
    return speed.Subject(**rendering_of_frames())


def test_bctm_is_not_slower_than_opencv_in_a_loop_and_gives_its_result(centroid):
    found = speed.compare(centroid, repeats=5)
    assert found.agrees, found
    assert found.ratio <= found.limit == 1.0, found


def test_simulating_is_twenty_times_faster_than_counting_and_gives_its_light(rendering):
    found = speed.compare(rendering, repeats=2)
    assert found.agrees, found
    assert found.ratio <= found.limit == 0.05, found


@pytest.mark.parametrize("prepare", [light_of_frames, diffracted_frames])
def test_light_alone_keeps_its_ratio_to_brute_force_and_gives_its_result(prepare):
    found = speed.compare(speed.Subject(**prepare()), repeats=2)
    assert found.agrees, found
    assert found.ratio <= found.limit, found


def test_the_counted_light_is_an_oracle_for_the_total_of_a_frame():
    """Light through a hole: area times cosine, less what the foil's thickness shades."""
    preset = datasets.get("cmos-single-aperture")
    sensor = preset.condition("nominal").sensor
    scene = preset.scene("nominal", "test").part(0, 3)
    counted, exact = counted_light(sensor, scene), sensor.lit(scene)
    np.testing.assert_allclose(counted.sum(axis=(1, 2)), exact.sum(axis=(1, 2)), rtol=2e-3)
    most = sensor.camera.mask.apertures[0].area_mm2 / sensor.detector.pitch_mm**2
    assert (counted.sum(axis=(1, 2)) <= most * scene.irradiance).all()


def subject(ratio, worst):
    """A subject whose work takes `ratio` times its reference's, by doing so many more items."""

    def work():
        return np.linalg.svd(np.eye(60))

    return speed.Subject("s", "r", work, work, 1000, int(1000 * ratio), 0.5, worst, 1e-3)


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
    else:
        assert ("BROKEN" in out) is (ratio > 0.5)
        assert ("DISAGREES" in out) is (worst > 0)


def test_no_repeats_are_refused(capsys):
    with pytest.raises(SystemExit):
        speed.main(["--repeats", "0"])
    assert "--repeats must be at least 1; got 0" in capsys.readouterr().err
