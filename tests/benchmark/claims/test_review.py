"""The second reading of the claims: its quotations, its sensors, and what it lets a verdict be."""

from __future__ import annotations

import ast
import importlib
import os
from pathlib import Path

import pytest

import survey_data
from benchmark import datasets
from benchmark.claims.experiment import find_experiments
from benchmark.claims.ledger import ledger
from benchmark.claims.review import Review, published, reviews
from benchmark.claims.rules import claims

#: The survey's LaTeX source, which is not ours to publish; looked for beside this repository.
SURVEY = os.environ.get("SUNATLAS_SURVEY_TEXT") or next(
    map(str, (Path(__file__).parents[4] / "shared" / "survey").glob("000_*.txt")), ""
)
#: Words by which the survey names a value.
WORDS = {
    "PD": ("photodiode", "photocell", "analog"),
    "PVA": ("solar cell", "panel", "analog"),
    "QPD": ("quadrant photodiode", "analog"),
    "CCD": ("CCD", "digital"),
    "CMOS": ("CMOS", "APS", "digital"),
    "PDA": ("linear photodiode array", "digital"),
    "Event": ("TFS operation",),
    "Single-Ap.": ("pinhole",),
    "Multi-Ap.": ("multi-aperture", "multiple pinhole", "multi-spot"),
    "Slit": ("slit mask",),
    "L-Slit": ("L-slit",),
    "V-Slit": ("V-slit",),
    "N-Slit": ("N-shaped",),
    "Multi-Slit": ("multiple-slit", "16 uniformly spaced slits"),
    "Encoded": ("code dial", "coded aperture"),
}
#: Drawn readings are of no detector; what reads them takes any array's.
DRAWN = {
    "single_discs": "Single-Ap.",
    "spot_grids": "Multi-Ap.",
    "slit_images": "Slit",
}
ARRAYS = {"CCD", "CMOS", "PDA"}


def sensors(name: str) -> tuple[set[str], str]:
    """Detectors and mask of a data set, or of what an experiment draws."""
    if name in DRAWN:
        return ARRAYS, DRAWN[name]
    preset = datasets.get(name)
    return {preset.detector}, preset.mask


def imported(module: str) -> set[str]:
    """Data sets, and modules that draw readings, that an experiment imports."""
    file = importlib.import_module(module).__file__
    assert file
    names: set[str] = set()
    for node in ast.walk(ast.parse(Path(file).read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            folder, _, last = node.module.rpartition(".")
            if node.module == "benchmark.datasets.standard":
                names |= {alias.name.replace("_", "-") for alias in node.names}
            elif folder == "benchmark.datasets.standard":
                names.add(last.replace("_", "-"))
            elif last in DRAWN:
                names.add(last)
            elif folder.startswith("benchmark.claims.experiments."):
                names |= imported(node.module)
    return names


def test_every_claim_is_read_and_its_verdict_is_the_published_one() -> None:
    assert list(reviews()) == list(claims()) == list(survey_data.load().claims["id"])
    assert len(reviews()) == 55
    assert {e.claim.id: e.verdict for e in ledger()} == {n: r.verdict for n, r in reviews().items()}
    assert all(review.reason for review in reviews().values())


def test_quotations_stand_word_for_word_in_the_line_that_is_named() -> None:
    if not SURVEY:
        pytest.skip("SUNATLAS_SURVEY_TEXT names no survey text")
    lines = Path(SURVEY).read_text("utf-8").split("\n")
    for name, review in reviews().items():
        assert len(review.sentence) > 20
        assert review.sentence in lines[int(review.line) - 1], name
        assert bool(review.context) == bool(review.context_line)
        if review.context:
            assert review.context in lines[int(review.context_line) - 1], name


@pytest.mark.parametrize("name", sorted(reviews()))
def test_trial_and_sentence_name_the_same_sensor_or_it_is_not_its_case(name: str) -> None:
    review = reviews()[name]
    said = f"{review.sentence} {review.context}".casefold()
    for value in {*review.detector, *review.mask} - {"any"}:
        assert any(word.casefold() in said for word in WORDS[value]), value
    ran = [sensors(one) for one in review.trial]
    assert set(review.trial_detector) == set().union(*(detectors for detectors, _ in ran))
    assert set(review.trial_mask) == {mask for _, mask in ran}
    used = imported(find_experiments()[name].module)
    # others take its measure of an error alone
    assert used - ({"single_discs"} - set(review.trial)) == set(review.trial)
    assert same_sensor(review) or review.case == "not its case"


def same_sensor(review: Review) -> bool:
    """Whether every sensor of the trial is among those that the sentence allows."""
    return all(
        (review.detector == ("any",) or detectors & set(review.detector))
        and (review.mask == ("any",) or mask in review.mask)
        for detectors, mask in map(sensors, review.trial)
    )


def test_data_sets_of_the_trial_are_those_that_its_plan_names() -> None:
    for name, review in reviews().items():
        for one in set(review.trial) - set(DRAWN):
            assert one in claims()[name].measured_on, name


def test_nothing_refutes_a_sentence_but_its_own_case() -> None:
    assert published("refuted", "its case") == "refuted"
    assert published("refuted", "partly its case") == "not reproduced here"
    assert published("refuted", "not its case") == "not reproduced here"
    assert published("partly", "not its case") == "partly"
    for entry in ledger():
        assert entry.verdict != "refuted" or entry.review.case == "its case"
