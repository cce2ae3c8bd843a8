"""`sunatlas recommend`: the service's answer, and as text with three kinds of evidence apart."""

import csv
import io
import json
import re
from typing import get_args

import pytest
from typer.testing import CliRunner

from api.cells import cell
from api.cli import architectures
from api.cli.command_line import app
from registry.ranking import SORTS, Sort

ASKED = {
    "task": ["Accuracy", "FOV"],
    "exclude_mask": ["Slit"],
    "min_fov_deg": 60,
    "min_availability": 0.9,
    "survive": ["albedo", "noise"],
    "properties": ["Robust to noise"],
    "sort": "measured",
    "limit": 3,
    "calibrations": 2,
}


def sunatlas(*arguments):
    return CliRunner().invoke(app, ["recommend", *map(str, arguments)], catch_exceptions=False)


def options(asked):
    for name, value in asked.items():
        for one in value if isinstance(value, list) else [value]:
            yield from (f"--{name.replace('_', '-')}", one)


def text(*arguments):
    shown = sunatlas(*arguments)
    assert shown.exit_code == 0, shown.stderr
    return shown.stdout


def words(shown):
    """Return a text with every run of spaces and line ends as one space."""
    return " ".join(shown.split())


def blocks(shown):
    """Return the lines of each architecture: its own first."""
    return [block.splitlines() for block in re.split(r"\n\n(?=\d)", shown)[1:]]


def test_the_json_is_the_answer_of_the_service_to_the_same_question(atlas):
    served = atlas.get("/v1/recommendations", params=ASKED)
    assert served.status_code == 200
    assert json.loads(text(*options(ASKED), "--format", "json")) == served.json()
    assert served.json()["count"] > 0
    unasked = atlas.get("/v1/recommendations").json()
    assert json.loads(text("--format", "json")) == unasked


def test_the_csv_is_that_of_the_service(atlas):
    served = atlas.get("/v1/recommendations", params=ASKED, accept="text/csv")
    ours = csv.DictReader(io.StringIO(text(*options(ASKED), "--format", "csv")))
    theirs = csv.DictReader(io.StringIO(served.text))
    assert list(ours) == list(theirs)
    assert ours.fieldnames == theirs.fieldnames
    assert "measured_error_deg" in ours.fieldnames


@pytest.mark.parametrize(
    "asked", [[], list(options(ASKED)), ["--detector", "Event", "--mask", "Lens"]]
)
def test_no_line_is_wider_than_80_columns(asked):
    shown = sunatlas(*asked)
    lines = (shown.stdout + shown.stderr).splitlines()
    assert lines
    assert max(map(len, lines)) <= 80


def test_each_architecture_shows_the_three_kinds_of_evidence_in_lines_of_their_own(atlas):
    answer = atlas.get("/v1/recommendations?task=Accuracy&survive=albedo&limit=500").json()
    found = blocks(text("--task", "Accuracy", "--survive", "albedo", "--limit", 500))
    assert len(found) == answer["count"] > 5
    for lines, architecture in zip(found, answer["architectures"], strict=True):
        assert lines[0].split()[:4] == [
            str(architecture["rank"]), architecture["detector"], "+", architecture["mask"],
        ]  # fmt: skip
        assert ("Pareto" in lines[0]) == architecture["pareto"]
        said = dict.fromkeys(("advised", "used", "measured", "contrary"), "")
        label = ""
        for line in lines[1:]:
            label = line[4:14].strip() or label
            if label in said:
                said[label] += f" {line[15:]}"
        for one in architecture["advice"]:
            assert f"{one['value']}: " in said["advised"]
            assert f"{one['model_category']}, {one['extractor']}" in said["advised"]
            assert f"(in {one['section_name']})" in said["advised"]
        assert said["advised"].split()[0] == ("Accuracy:" if architecture["advised"] else "not")
        used = re.findall(r"[A-Za-z]+\d{4}[a-z]?", said["used"])
        assert used == architecture["studies"]
        best = architecture["best"]["measured"]
        assert f"{best['error_deg']:.3g} deg" in said["measured"]
        assert f"({best['dataset']}, {best['condition']})" in words(said["measured"])
        assert f"{best['nominal']['bound_deg']:.3g} deg" in said["measured"]
        assert words(architecture["contradiction"] or "") == words(said["contrary"])


def test_calibrations_say_which_are_in_no_study(atlas):
    question = "mask=Encoded&detector=CMOS&calibrations=500"
    (architecture,) = atlas.get(f"/v1/recommendations?{question}").json()["architectures"]
    shown = text("--mask", "Encoded", "--detector", "CMOS", "--calibrations", 500)
    (lines,) = blocks(shown)
    heading = next(line for line in lines if line.split()[:1] == ["calibration"])
    at = heading.index("studies")
    rows = [line for line in lines[lines.index(heading) + 1 :] if line[4:8].strip()]
    column = [line[at:].split()[0] for line in rows]
    assert column == [str(len(c["studies"]) or "none") for c in architecture["calibrations"]]
    assert "none" in column
    assert column[0] != "none"


def test_what_disagrees_costs_or_is_not_tried_is_said(atlas):
    found = atlas.get("/v1/recommendations?survive=spin").json()
    shown = words(text("--survive", "spin"))
    assert words(found["regret"]["sentence"]) in shown
    pair = found["untried"]["spin"][0]
    untried = shown[shown.index(" spin: ") :]
    assert f"{pair['detector']} + {pair['mask']}" in untried
    found = atlas.get("/v1/recommendations").json()
    assert found["contradictions"]
    assert all(words(sentence) in words(text()) for sentence in found["contradictions"])


def test_the_order_is_the_one_asked_for():
    for sort in SORTS:
        assert architectures.ORDERS[sort] in words(text("--sort", sort, "--limit", 1))
    assert get_args(Sort) == SORTS


def test_what_cannot_be_met_names_the_requirement_and_what_would_help(atlas):
    impossible = {"detector": "Event", "max_error_deg": 1e-9}
    blocked = atlas.get("/v1/recommendations", params=impossible).json()["blocked"]
    shown = sunatlas(*options(impossible))
    assert shown.exit_code == 0
    assert shown.stdout.startswith("0 architectures")
    said = words(shown.stderr)
    assert f"{blocked['constraint']}: {words(blocked['detail'])}" in said
    assert blocked["relaxations"]
    for relaxation in blocked["relaxations"]:
        assert f"- {words(relaxation['words'])}: {relaxation['architectures']} arch" in said


def test_what_is_far_finer_where_it_answers_is_named_by_command_page_and_table(atlas):
    """A lens without the fine extractors: what answers everywhere is coarse."""
    fine = ["HT", "MT-ACM", "PPE", "PM", "None", "BCTM"]
    asked = {"detector": "CCD", "mask": "Lens", "exclude_extractor": fine}
    (place,) = atlas.get("/v1/recommendations", params=asked).json()["architectures"]
    finer = place["best"]["measured"]["finer"]
    assert 0.5 <= finer["availability"] < 0.95
    assert 3 * finer["error_deg"] < place["best"]["measured"]["error_deg"]
    shown = words(sunatlas(*options(asked)).stdout)
    share = f"{100 * finer['availability']:.4g} %"
    assert f"{share} availability: {finer['extractor']} + {finer['model']}" in shown
    page = atlas.get("/", params=asked).text
    assert f"({finer['extractor']} + {finer['model']})" in page
    best = place["best"]["rank"]
    table = atlas.get("/v1/recommendations", params={**asked, "calibrations": 500, "format": "csv"})
    row = list(csv.DictReader(table.text.splitlines()))[best - 1]
    assert {name: row[f"measured_finer_{name}"] for name in finer} == {
        name: cell(value) for name, value in finer.items()
    }


def test_a_pipeline_that_answers_too_seldom_has_no_error_and_says_so():
    measured = {"extractor": "a", "model": "b + c", "dataset": "d", "condition": "hot",
                "error_deg": None, "field_deg": None,
                "nominal": {"condition": "nominal", "rms_deg": 0.5, "bound_deg": 0.1,
                            "over_bound": 2345.6},
                "availability": 0.25, "units": None, "own_deg": None, "bench_deg": None,
                "needs": []}  # fmt: skip
    calibration = {"rank": 1, "extractor": "A", "compensations": ["B"], "model": "C",
                   "advised": [], "studies": [], "measured": measured}  # fmt: skip
    architecture = {"rank": 1, "detector": "D", "mask": "M", "tasks": [], "advice": [],
                    "studies": [], "best": calibration, "pareto": False, "contradiction": None,
                    "measures": [], "count": 2,
                    "calibrations": [calibration, {**calibration, "measured": None}],
                    }  # fmt: skip
    document = {"sort": "advice", "count": 1, "designs": 2, "architectures": [architecture],
                "contradictions": [], "regret": None, "untimed": 3,
                "untried": {}}  # fmt: skip
    shown = words(architectures.text(document, 80))
    assert "0.5 deg; 2346" in shown
    assert "availability 25 %" in shown
    assert "not timed 3 pipelines" in shown
    assert "a + b + c" in shown
    assert "A + B + C" in shown


def test_no_calibration_is_called_none():
    shown = words(text("--survive", "ageing"))
    assert "None +" not in shown
    assert "+ None" not in shown
