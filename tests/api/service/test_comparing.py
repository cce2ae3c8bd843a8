"""Comparisons say what the boards, curves and studies say; what does not fit is refused."""

import pytest

from api.service.comparing import compare_architectures, compare_pipelines
from registry.taxonomy import InvalidValueError

DATASET = "cmos-single-aperture"


@pytest.fixture(scope="module")
def known(atlas):
    return atlas.app.state.knowledge


def test_pipelines_have_the_numbers_of_their_scores_and_curves(atlas, known):
    curves = atlas.get(f"/v1/curves?dataset={DATASET}").json()["items"]
    names = [f"{c['extractor']}:{c['model']}" for c in curves][:3]
    assert len(names) >= 2
    found = compare_pipelines(known, DATASET, names, "hot")
    assert (found["dataset"], found["condition"]) == (DATASET, "hot")
    assert [f"{i['extractor']}:{i['model']}" for i in found["items"]] == names
    for item, curve in zip(found["items"], curves, strict=False):
        asked = {k: item[k] for k in ("extractor", "model")} | {"dataset": DATASET}
        scores = atlas.request("GET", "/v1/results", params=asked).json()["items"]
        by = {score["condition"]: score for score in scores}
        for name in ("bound_deg", "availability", "over_bound"):
            assert item[name] == by["hot"][name]
        (board,) = (
            row
            for row in known.measurements.board_rows(DATASET)
            if (row["condition"], row["extractor"], row["model"])
            == ("hot", item["extractor"], item["model"])
        )
        assert item["own_error_deg"] == board["own_error_deg"]  # over the units measured
        assert len(board["unit_rms_deg"]) in {1, 10}
        assert {c: v["rms_all_answers_deg"] for c, v in item["conditions"].items()} == {
            c: score["rms_all_answers_deg"] for c, score in by.items() if c != "on-bench"
        }
        assert item["needed_poses"] == curve["needed_poses"]
        for ring in item["rings"]:
            name = f"rms_{ring['inner_deg']:g}_{ring['outer_deg']:g}_deg"
            assert ring["rms_deg"] == by["hot"][name]
    errors = [item["own_error_deg"] for item in found["items"]]
    assert [i["ratio_to_smallest"] for i in found["items"]] == [e / min(errors) for e in errors]


def test_architectures_have_their_best_pipeline_and_their_studies(atlas, known):
    best = {
        f"{row['detector']}:{row['mask']}": row
        for row in atlas.get("/v1/leaderboard/architectures?limit=500").json()["items"]
    }
    names = ["QPD:Single-Ap.", "CMOS:Single-Ap.", "CMOS:Multi-Ap."]
    found = compare_architectures(known, names)["items"]
    for item, name in zip(found, names, strict=True):
        assert f"{item['detector']}:{item['mask']}" == name
        for member in (
            "dataset",
            "extractor",
            "model",
            "own_error_deg",
            "over_bound",
            "half_fov_deg",
        ):
            assert item[member] == best[name][member]
    listed = atlas.get("/v1/studies?detector=CMOS&mask=Multi-Ap.").json()["items"]
    assert set(found[2]["proposed"]) <= {study["key"] for study in listed}
    assert len(found[2]["proposed"]) > 3


def test_what_errs_far_less_under_a_condition_is_named_with_its_share(atlas, known):
    """Held against the boards: the least error of what answers half, if below a third."""
    names = ["CMOS:Encoded", "CMOS:Single-Ap.", "CMOS:Multi-Ap.", "QPD:Single-Ap."]
    named = 0
    for item in compare_architectures(known, names)["items"]:
        for condition, scored in item["conditions"].items():
            asked = f"/v1/leaderboard/{item['dataset']}?condition={condition}&limit=500"
            rows = [
                row
                for row in atlas.walk(asked)
                if row["rms_all_answers_deg"] is not None and row["availability"] >= 0.5
            ]
            if not rows:
                assert scored["partial_answer"] is None
                continue
            least = min(rows, key=lambda row: row["rms_all_answers_deg"])
            error = scored["rms_all_answers_deg"]
            if error is None or error <= 3 * least["rms_all_answers_deg"]:
                assert scored["partial_answer"] is None
                continue
            named += 1
            assert scored["partial_answer"]["rms_all_answers_deg"] == least["rms_all_answers_deg"]
            for member, value in scored["partial_answer"].items():
                assert value == least[member]
    assert named >= 0
    found = compare_pipelines(known, DATASET, ["bctm:spm", "mirror:homography"])
    assert {i["partial_answer"] for i in found["items"]} == {None}


@pytest.mark.parametrize(
    ("pipelines", "condition", "parameter"),
    [
        (["bctm:spm"], None, "pipeline"),
        (["bctm:spm", "bctm:spm"], None, "pipeline"),
        (["bctm:spm"] * 5, None, "pipeline"),
        (["bctm:spm", "bctm:smp"], None, "pipeline"),
        (["bctm:spm", "mirror:homography"], "foggy", "condition"),
    ],
)
def test_what_cannot_be_compared_is_refused(known, pipelines, condition, parameter):
    with pytest.raises(InvalidValueError) as refused:
        compare_pipelines(known, DATASET, pipelines, condition)
    assert refused.value.parameter == parameter


def test_contradictions_of_an_answer_have_the_errors_of_the_board(atlas, known):
    """To five digits, and their ratio to three."""
    found = atlas.get("/v1/recommendations?detector=CMOS&detector=QPD&mask=Single-Ap.").json()
    assert found["contradictions"]
    for one in found["contradictions"]:
        own = {
            f"{row['extractor']} + {row['model']}": row["own_error_deg"]
            for row in known.measurements.board_rows(one["dataset"])
            if row["condition"] == one["condition"]
        }
        for side in ("first", "other"):
            assert one[f"{side}_own_error_deg"] == float(f"{own[one[side]]:.5g}")
        assert one["ratio"] == float(f"{own[one['first']] / own[one['other']]:.3g}")
        assert f"{one['ratio']:.3g} times smaller" in one["sentence"]
