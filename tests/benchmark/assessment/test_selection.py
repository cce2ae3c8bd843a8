"""Settings chosen on standard data sets, beside the best fixed ones in hindsight."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import sun_from_angles
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.assessment.selection import SETTINGS, WORST, SelectionData, choices, chosen_and_best
from benchmark.plan.parts import installed_parts


def test_every_model_that_chooses_is_compared():
    """A setting that is None unless given is one that the samples choose."""
    choosing = {
        name
        for name, model in installed_parts().models.items()
        for field in getattr(model, "__dataclass_fields__", {}).values()
        if field.name in {"degree", "smoothing", "harmonics"} and field.default is None
    }
    assert set(SETTINGS) == choosing


def test_a_choice_is_set_beside_the_best_degree_of_all():
    """A cubic without noise: every degree from the third on is as good as rounding."""
    axis = np.linspace(-20.0, 20.0, 9)
    angles = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    between = np.random.default_rng(2).uniform(-18.0, 18.0, (50, 2))

    def read(a):  # beta on x, alpha on y, each bent
        return a[:, ::-1] + 1e-3 * a[:, ::-1] ** 3

    data = SelectionData(
        read(angles), sun_from_angles(angles), read(between), sun_from_angles(between)
    )
    settings = [{"degree": 1}, {"degree": 7}]
    chosen, best, chosen_deg, best_deg = chosen_and_best(AxisPolynomial(), settings, data)
    assert best == {"degree": 7}
    assert chosen["degree"] >= 5
    assert chosen_deg < 2.0 * best_deg


@pytest.mark.slow
def test_choices_on_two_square_detectors_are_as_good_as_the_best():
    found = list(choices(["psd-single-aperture", "qpd-single-aperture"]))
    assert len(found) == 10
    assert max(choice.ratio for choice in found) <= WORST
