"""The names of the survey's labels: its own headings, captions and numbers."""

from __future__ import annotations

import csv
import re

from survey_data import labels
from survey_data.descriptor import DATA_DIRECTORY


def _held() -> dict[str, tuple[str, str, str]]:
    with (DATA_DIRECTORY / "labels.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {row["label"]: (row["kind"], row["number"], row["title"]) for row in rows}


def test_numbers_counted_by_hand_in_the_print() -> None:
    # Sections: introduction 1, measurement model 2, methodology 3, attributes 4, models 5, ...
    # Tables: mapping 1, models 2, extractors 3, assessment 4, approaches 5.
    held = _held()
    assert held["sec:attribanalysis"] == ("section", "4", "Sensor attribute analysis")
    assert held["tab:mrlit"][:2] == ("table", "2")
    assert held["tab:fesummary"][:2] == ("table", "4")
    assert held["model:lut"] == ("subsection", "5.1", "Lookup table model")
    assert held["eq:lsq"][1] == "3"  # after the Fourier series and the standard projection
    assert held["sec:appendixa"][1] == "A"


def test_a_label_alone_is_named_in_full_and_within_a_sentence_by_its_number() -> None:
    assert labels.label_of("sec:attribanalysis") == "Section 4 “Sensor attribute analysis”"
    assert labels.label_of("absent from tab:mrlit") == "absent from Table 2"
    lsq = labels.label_of("eq:lsq of model:lsq")
    assert re.fullmatch(r"Equation 3 of Section 5\.3 “.*LSQ.*”", lsq)
    assert labels.label_of("sec:appendixa") == "Appendix A “Data availability”"


def test_what_only_looks_like_a_label_stays_as_it_is() -> None:
    for text in ("without a model: a foil", "model:unheardof", "tab:", ""):
        assert labels.label_of(text) == text
