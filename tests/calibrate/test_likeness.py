"""A sensor behaves like the standard one on which models rank as on its own data."""

from __future__ import annotations

import pytest

from calibrate.likeness import alike

MINE = {"a": 0.1, "b": 0.2, "c": 1.0, "d": 4.0, "e": 5.0}


def scored(dataset, extractor, **errors):
    return {
        (dataset, extractor, model): {
            "status": "ok" if rms else "unfit", "own_error_deg": rms, "detector": "D", "mask": "M",
        }
        for model, rms in errors.items()
    }  # fmt: skip


def test_ratios_between_models_decide_and_not_their_size():
    nominal = {
        **scored("near", "x", a=1.0, b=2.0, c=10.0, d=40.0, e=50.0, f=1.0),
        **scored("near", "y", a=1.0, b=1.0, c=1.0, d=1.0, e=1.0),
        **scored("flat", "x", a=0.1, b=0.1, c=0.1, d=0.1),
        **scored("few", "x", a=0.1, b=0.2, c=None),
    }
    found = alike(MINE, nominal)
    assert [(one.dataset, one.extractor) for one in found] == [("near", "x"), ("flat", "x")]
    assert found[0].factor == pytest.approx(1.0)
    assert set(found[0].errors_deg) == set("abcde")
