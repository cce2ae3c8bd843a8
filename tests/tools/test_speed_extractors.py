"""Methods beside peers on the reference frames: limits, verdicts and libraries not installed."""

from __future__ import annotations

import importlib
import json
import re

import numpy as np
import pytest

from benchmark.synthetic_features.frames import REFERENCE_SETS
from tools.bench import extractor_peers as speed_extractors_peers
from tools.bench import extractors as speed_extractors
from tools.bench.extractor_limits import (
    LIMITS,
    OPENCV,
    Figures,
    over_noise,
    verdicts,
)
from tools.bench.verdicts import Verdict, any_broken


def test_every_limit_is_on_a_method_and_a_set_that_are_measured():
    for limit in LIMITS:
        for name in limit.sets:
            assert limit.method in speed_extractors.methods(REFERENCE_SETS[name])


def figures(over_bound=1.0, over_opencv=0.1, error_px=0.01, frames=1000):
    return Figures(error_px, over_bound, over_opencv, frames)


def test_a_limit_is_broken_where_no_reason_excuses_it():
    loop = figures(error_px=0.02)
    kept = verdicts({("disc", "bctm"): figures(), ("disc", OPENCV): loop})
    assert [verdict.most for verdict in kept] == [0.15, 1.0]
    assert not any_broken(kept)
    assert any_broken(verdicts({("disc", "bctm"): figures(over_opencv=0.16)}))
    worse = {("disc", "bctm"): figures(error_px=0.03), ("disc", OPENCV): loop}
    assert any_broken(verdicts(worse))
    [known] = verdicts({("disc", "tm"): figures(over_bound=10.6)})
    assert not known.holds
    assert "two levels" in known.cannot
    assert not any_broken([known])
    assert any_broken(verdicts({("disc", "tm binarise=no"): figures(over_bound=float("nan"))}))


def test_an_error_of_few_frames_is_not_judged():
    assert not verdicts({("disc", "tm binarise=no"): figures(over_bound=1.4, frames=999)})
    assert any_broken(verdicts({("disc", "tm binarise=no"): figures(over_bound=1.4, frames=1000)}))


def test_the_range_of_noise_is_the_ratio_of_its_ends():
    found = over_noise("tm", (0.05, 0.07))
    assert found == Verdict(found.what, pytest.approx(1.4), 1.5)
    assert re.search(r"^tm on disc: .*\b20\b.*\b1 e-", found.what)


def test_a_library_that_is_not_installed_is_named(monkeypatch, capsys):
    real = importlib.import_module

    def without(name, *rest):
        if name.split(".")[0] in {"photutils", "sep", "skimage"}:
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(speed_extractors_peers.importlib, "import_module", without)
    found, missing = speed_extractors_peers.peers()
    assert missing == ["photutils", "sep", "scikit-image"]
    assert set(found) == {
        "scipy center_of_mass",
        "scipy curve_fit gaussian",
        "scipy curve_fit ellipse",
    }
    given = ["--sets", "gaussian", "--methods", "pm", "--frames", "20", "--repeats", "1"]
    speed_extractors.main(given)
    assert "scikit-image: not installed" in capsys.readouterr().out


@pytest.mark.slow
def test_peers_that_are_there_find_the_spot():
    """What is installed here; the whole-frame moments are biased, the rest are not."""
    frames, centres = REFERENCE_SETS["disc"].frames(4)
    for name, peer in speed_extractors_peers.peers()[0].items():
        error = np.abs(peer(frames) - centres).max()
        assert error < (0.5 if name == "photutils centroid_com" else 0.2) or (
            name == "photutils centroid_quadratic"  # the brightest pixel of a flat disc
        )


def test_the_report_carries_limits_and_its_status(monkeypatch, capsys):
    given = ["--sets", "disc", "--methods", "tm", "bctm", OPENCV, "--frames", "20"]
    given += ["--repeats", "1", "--format", "json"]
    status = speed_extractors.main(given)
    found = json.loads(capsys.readouterr().out)
    assert {row["method"] for row in found["measured"]} == {"tm", "bctm", OPENCV}
    assert {limit["what"].split(" on ")[0] for limit in found["limits"]} == {"tm", "bctm"}
    unexcused = [limit for limit in found["limits"] if not limit["holds"] and not limit["cannot"]]
    assert status == (1 if unexcused else 0)
