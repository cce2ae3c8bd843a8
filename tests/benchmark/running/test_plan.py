"""What is measured, what is not, and why."""

import dataclasses

import fake_atlas
import fake_plan
import pytest

from algorithms.contract import UnsuitableDesignError
from benchmark.contract import Cell, UnknownNameError
from benchmark.plan import combinations as plan


@pytest.fixture
def parts():
    return fake_plan.parts()


def test_every_compatible_combination_is_planned_in_sorted_order(parts):
    found = plan.cells(parts=parts)
    assert found == sorted(
        Cell("fake-diodes", condition, extractor, "fake-least-squares")
        for condition in ("quiet", "noisy")
        for extractor in ("fake-currents", "fake-gaps")
    )


def test_cells_and_incompatible_pairs_together_are_everything(parts):
    planned = {(c.dataset, c.extractor, c.model) for c in plan.cells(parts=parts)}
    refused = plan.list_exclusions(parts=parts)
    assert [(r.extractor, r.model) for r in refused] == [("fake-balanced", ""), ("fake-framed", "")]
    assert "aperture_width_mm" in refused[0].reason
    assert "reads frames; the dataset has currents" in refused[1].reason
    assert len(planned) + len(refused) == len(parts.extractors) * len(parts.models)


def test_features_a_model_cannot_read_are_refused_with_the_reason(parts):
    class Spots(fake_atlas.LeastSquares):
        about = dataclasses.replace(
            fake_atlas.LeastSquares.about,
            name="fake-spots",
            accepts=frozenset({fake_atlas.FeatureKind.SPOT}),
        )

    refused = plan.list_exclusions(
        extractors="fake-currents", models="fake-spots", parts=fake_plan.parts(Spots)
    )
    assert [r.reason for r in refused] == ["accepts spot; the extractor gives signals"]


def test_a_design_that_an_implementation_refuses_is_not_planned_and_says_why():
    class Pairs(fake_atlas.LeastSquares):
        about = dataclasses.replace(fake_atlas.LeastSquares.about, name="fake-pairs")

        @classmethod
        def for_sensor(cls, geometry, kind):
            raise UnsuitableDesignError(f"needs two faces; got {len(geometry.face_normals)}")

    class Halves(fake_atlas.Currents):
        about = dataclasses.replace(fake_atlas.Currents.about, name="fake-halves")

        @classmethod
        def for_sensor(cls, geometry):
            raise UnsuitableDesignError("needs halves")

    parts = fake_plan.parts(fake_atlas.LeastSquares, Pairs)
    parts = dataclasses.replace(parts, extractors={**parts.extractors, "fake-halves": Halves})
    assert {c.model for c in plan.cells(parts=parts)} == {"fake-least-squares"}
    assert "fake-halves" not in {c.extractor for c in plan.cells(parts=parts)}
    faces = len(fake_atlas.Diodes().geometry.face_normals)
    refused = {(r.extractor, r.model): r.reason for r in plan.list_exclusions(parts=parts)}
    assert refused["fake-currents", "fake-pairs"] == f"needs two faces; got {faces}"
    assert refused["fake-halves", ""] == "needs halves"


@pytest.mark.parametrize("error", [ValueError, RuntimeError, TypeError])
def test_a_defect_of_an_implementation_is_planned_so_that_its_row_says_what_failed(error):
    """Only the contract's own word for a design is a refusal; a plain ValueError is none."""

    class Defective(fake_atlas.LeastSquares):
        about = dataclasses.replace(fake_atlas.LeastSquares.about, name="fake-defective")

        @classmethod
        def for_sensor(cls, geometry, kind):
            raise error("typo")

    class Blind(fake_atlas.Currents):
        about = dataclasses.replace(fake_atlas.Currents.about, name="fake-blind")

        @classmethod
        def for_sensor(cls, geometry):
            raise error("typo")

    parts = fake_plan.parts(fake_atlas.LeastSquares, Defective)
    parts = dataclasses.replace(parts, extractors={**parts.extractors, "fake-blind": Blind})
    planned = {(cell.extractor, cell.model) for cell in plan.cells(parts=parts)}
    assert {("fake-currents", "fake-defective"), ("fake-blind", "fake-least-squares")} <= planned
    refused = {(one.extractor, one.model) for one in plan.list_exclusions(parts=parts)}
    assert refused == {("fake-balanced", ""), ("fake-framed", "")}


@pytest.mark.parametrize(
    ("argument", "given", "nearest"),
    [
        ("datasets", "fake-diode", "fake-diodes"),
        ("conditions", "nois", "noisy"),
        ("extractors", "Fake-Curents", "fake-currents"),
        ("models", "fake-least-square", "fake-least-squares"),
    ],
)
def test_an_unknown_name_raises_with_the_nearest(parts, argument, given, nearest):
    with pytest.raises(UnknownNameError, match=nearest) as caught:
        plan.cells(**{argument: given}, parts=parts)
    assert caught.value.nearest == nearest


def test_parts_of_cells_are_theirs_alone(parts):
    one = Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    found = parts.only([one, dataclasses.replace(one, condition="noisy")])
    assert set(found.presets) == {"fake-diodes"}
    assert set(found.extractors) == {"fake-currents"}
    assert set(found.models) == {"fake-least-squares"}
    with pytest.raises(UnknownNameError, match="fake-least-square"):
        parts.only([dataclasses.replace(one, model="fake-least-square")])
