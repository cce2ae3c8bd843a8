"""Compensations ahead of models: named, made for a sensor, fitted in order, refused where none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from algorithms.chain import Chain, chains
from algorithms.compensations.combinations import combinations
from algorithms.compensations.optics.refraction import Refraction
from algorithms.contract import FeatureKind, SensorGeometry, UnsuitableDesignError
from algorithms.discovery import discover_chains, discover_compensations, discover_models
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.extractors.profiles.centroid import ProfileCentroid
from algorithms.models.geometric.multi_slit import MultiSlit
from algorithms.models.geometric.standard_projection import StandardProjection


def test_every_compensation_goes_ahead_of_something_that_there_is():
    found = discover_chains()
    assert set(discover_models()) < set(found)
    for name, compensation in discover_compensations().items():
        for behind in compensation.about.ahead_of:
            chain = found[f"{name} + {behind}"]
            assert chain.about.taxonomy == compensation.about.taxonomy
        assert compensation.about.ahead_of, f"{name} is never measured"


def test_a_chain_has_a_new_version_where_any_part_has_one():
    class Newer(Refraction):
        about = replace(Refraction.about, version=3)

    class Newest(StandardProjection):
        about = replace(StandardProjection.about, version=5)

    assert Chain((Newer,), Newest).about.version == 7
    assert Chain((Newer, Newer), Newest).about.version == 9


def test_a_chain_is_made_for_a_sensor_and_answers_as_its_parts_do(geometry, field):
    design = replace(geometry, cover_glass=((0.5, 1.5),))
    spots = 200.0 + 150.0 * field[:, :2] / field[:, 2:]
    made = Chain((Refraction,), StandardProjection).for_sensor(design, FeatureKind.SPOT)
    glass = Refraction.for_sensor(design, FeatureKind.SPOT).fit(spots, field)
    alone = StandardProjection.for_sensor(design, FeatureKind.SPOT).fit(spots, field)
    found = made.fit(spots, field).predict(spots)
    np.testing.assert_array_equal(found, alone.predict(glass.transform(spots)))
    kept = Chain((Refraction,), StandardProjection).pipeline(BasicCentroid, design)
    assert kept.name == "optical + spm"
    np.testing.assert_array_equal(kept.fit_features(spots, field).predict_features(spots), found)
    with pytest.raises(UnsuitableDesignError, match="cover_glass"):
        Chain((Refraction,), StandardProjection).for_sensor(geometry, FeatureKind.SPOT)


@pytest.mark.parametrize(
    ("behind", "said"),
    [("nobody", "no such model"), ("nobody + spm", "no such model"), ("basic", "other features")],
)
def test_a_compensation_ahead_of_what_cannot_be_is_named(behind, said):
    class Lost(Refraction):
        about = replace(Refraction.about, ahead_of=(behind,))

    with pytest.raises(ValueError, match=f"optical goes ahead of .*{said}"):
        chains({"optical": Lost}, discover_models())


def test_glass_that_a_compensation_takes_out_is_not_the_models_behind(field):
    design = SensorGeometry(
        focal_length_mm=1.8,
        pixel_pitch_mm=0.01,
        centre_px=(500.0, 500.0),
        half_fov_deg=50.0,
        line_axes=("x", "y"),
        line_pixels=1000,
        slits=((-0.6, 0.0, 0.2), (0.7, 0.0, 0.2)),
        cover_glass=((0.5, 1.5),),
    )
    chain = discover_chains()["optical + multi-slit"]
    assert chain.about.needs == ("focal_length_mm", "cover_glass", *MultiSlit.about.needs[1:])
    assert "Enright2007a" in chain.about.studies
    made = chain.for_sensor(design, FeatureKind.SPOT)
    assert made.model.cover_glass == ()
    assert chain.pipeline(ProfileCentroid, design).model == made.model
    tangents, vector = field[:, :2] / field[:, 2:], np.array([1.8, 0.0] * 2 + [0.0] * 4)
    under_glass = MultiSlit.for_sensor(design, FeatureKind.SPOT).cast(vector, tangents)
    in_air = made.model.cast(vector, tangents)
    assert np.abs(under_glass - in_air).max() > 10.0
    freed = made.compensations[0].fit(under_glass, field).transform(under_glass)
    np.testing.assert_allclose(freed, in_air, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nobody + spm", "nobody is none"),
        ("optical + nobody", "nobody is none"),
        ("spm", "no part is a compensation"),
        ("optical + basic", "different features"),
    ],
)
def test_a_combination_that_cannot_be_made_is_named(name, said):
    with pytest.raises(ValueError, match=said):
        combinations(discover_compensations(), discover_models(), {name: ("Wei2011",)})
