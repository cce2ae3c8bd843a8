"""What every model must do that reads samples in the order of time, check by check.

Those of a model of single samples that hold for it too come first; where such a one asks that a row
be answered alone, a filter must instead not look ahead, and begin anew with every series.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import model_checks
import numpy as np
import pytest
from expectations import same
from shared_fits import learnt

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, UnusableDataError, parameters

SEQUENCE_CHECKS: list[Callable[..., None]] = [
    model_checks.check_model_keeps_the_contract,
    model_checks.check_model_is_documented,
    model_checks.check_fitted_attributes_appear_with_fit,
    model_checks.check_parameters_are_plain_and_kept,
    model_checks.check_predict_before_fit_says_so,
    model_checks.check_model_refuses_wrong_features,
    model_checks.check_model_refuses_wrong_suns,
    model_checks.check_a_refused_fit_leaves_no_trace,
    model_checks.check_model_is_deterministic_and_forgets_the_fit_before,
    model_checks.check_model_leaves_input_alone,
    model_checks.check_model_survives_pickling,
    model_checks.check_refuses_other_kinds_and_names_missing_geometry,
    model_checks.check_a_saved_fit_answers_to_the_last_bit,
    model_checks.check_context_that_is_not_read_is_not_looked_at,
]


def sequence_check(function):
    SEQUENCE_CHECKS.append(function)
    return function


@sequence_check
def check_follows_the_sun_it_learnt(cls, model, cal):
    model, found = learnt(model, cal)
    assert found.shape == cal.sun.shape
    assert np.isnan(found[0]).all()  # one reading is no sequence yet
    np.testing.assert_allclose(np.linalg.norm(found[1:], axis=1), 1.0, atol=1e-14)
    assert np.sqrt(np.mean(separation_deg(found[1:], cal.sun[1:]) ** 2)) < 1.0
    assert model.quality_.residual_rms_deg == pytest.approx(
        np.sqrt(np.nanmean(separation_deg(found, cal.sun) ** 2)), rel=1e-9
    )


@sequence_check
def check_never_looks_ahead(cls, model, cal):
    model, whole = learnt(model, cal)
    for stop in (1, 2, 3, 17, 90):
        part = cal.of(slice(stop))
        same(model.predict(part.features, part.context), whole[:stop])


@sequence_check
def check_a_row_without_features_is_nan_and_the_next_is_answered(cls, model, cal):
    model, _ = learnt(model, cal)
    for bad in (np.nan, np.inf):
        broken = cal.features.copy()
        broken[40:44, 0] = bad
        found = model.predict(broken, cal.context)
        assert np.isnan(found[40:44]).all()
        assert separation_deg(found[44:], cal.sun[44:]).max() < 2.0
    assert np.isnan(model.predict(np.full_like(cal.features, np.nan), cal.context)).all()


@sequence_check
def check_in_eclipse_no_sun_is_invented(cls, model, cal):
    """Whatever the features are; beneath the silence it goes on by dead reckoning, less sure."""
    model, _ = learnt(model, cal)
    context = {name: column.copy() for name, column in cal.context.items()}
    context["eclipse"][60:90] = 1.0
    found = model.predict(cal.features, context)
    assert np.isnan(found[60:90]).all()
    assert np.isnan(model.deviation_deg(cal.features, context)[60:90]).all()
    track = model.track(cal.features, context)
    assert not track.is_read[60:90].any()
    assert (np.diff(track.deviation_deg[60:90]) > 0).all()
    assert separation_deg(track.sun[60:90], cal.sun[60:90]).max() < 3.0
    assert np.isfinite(found[90:]).all()


@sequence_check
def check_in_the_dark_no_sun_is_invented(cls, model, cal):
    """Faces without light are dark, whatever the context says."""
    model, _ = learnt(model, cal)
    if cal.features.shape[1] == 2:  # a spot does not tell what made it
        return
    dark = cal.features.copy()
    dark[30:50] = 0.0
    assert np.isnan(model.predict(dark, cal.context)[30:50]).all()
    first = cal.of(slice(20))
    assert np.isnan(model.predict(np.zeros_like(first.features), first.context)).all()


@sequence_check
def check_a_series_begins_anew_where_time_does_not_go_on(cls, model, cal):
    """Back to the start, or past a gap: the same answers as alone, at the same time."""
    model, alone = learnt(model, cal)
    half = len(cal.sun) // 2
    gap = {name: column.copy() for name, column in cal.context.items()}
    gap["time_s"][half:] += 5000.0
    later = {name: column[half:] for name, column in gap.items()}
    again = model.predict(cal.features[half:], later)
    same(model.predict(cal.features, gap), np.concatenate([alone[:half], again]))
    twice = cal.of(np.tile(np.arange(len(cal.sun)), 2))
    same(model.predict(twice.features, twice.context), np.concatenate([alone, alone]))
    assert set(model.track(twice.features, twice.context).series) == {0, 1}


@sequence_check
def check_samples_that_do_not_follow_each_other_are_not_answered(cls, model, cal):
    """The split `repeat` is of poses far apart, pass after pass: no sequence, no repeatability."""
    model, _ = learnt(model, cal)
    poses = cal.of(np.tile(np.arange(5, len(cal.sun), 40), 3))
    assert np.isnan(model.predict(poses.features, poses.context)).all()


@sequence_check
def check_layouts_and_dtypes_agree(cls, model, cal):
    model, expected = learnt(model, cal)
    for features in (np.asfortranarray(cal.features), cal.features.tolist()):
        same(model.predict(features, cal.context), expected)


@sequence_check
def check_what_does_not_settle_it_is_refused(cls, model, cal):
    nothing = replace(cal, features=np.full_like(cal.features, np.nan))
    shuffled = replace(cal, sun=cal.sun[np.random.default_rng(2).permutation(len(cal.sun))])
    still = cal.of(np.zeros(len(cal.sun), dtype=int))
    for calibration in (nothing, shuffled, still, cal.of(slice(20))):
        with pytest.raises(UnusableDataError, match=model.about.name):
            model.fit(calibration.features, calibration.sun, calibration.context)


@sequence_check
def check_a_calibration_in_another_order_is_the_same(cls, model, cal):
    """Samples are put in the order of time; repeated rows without features are left out."""
    _, expected = learnt(model, cal)
    mixed = cal.of(np.random.default_rng(3).permutation(len(cal.sun)))
    other = cls(**parameters(model)).fit(mixed.features, mixed.sun, mixed.context)
    same(other.predict(cal.features, cal.context), expected)


@sequence_check
def check_an_answer_has_a_deviation(cls, model, cal):
    model, found = learnt(model, cal)
    deviation = model.deviation_deg(cal.features, cal.context)
    assert np.array_equal(np.isfinite(deviation), np.isfinite(found[:, 0]))
    assert (deviation[1:] > 0).all()
    assert deviation[1:].max() < 10.0


@sequence_check
def check_every_kind_of_feature_is_read(cls, model, cal):
    assert cls.about.accepts == set(FeatureKind)
