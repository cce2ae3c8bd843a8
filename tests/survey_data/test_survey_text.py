"""What the survey's text says, counted by hand there: advice, protocol, roles, middle families."""

from __future__ import annotations

from collections import Counter

import pandas as pd

import survey_data
from survey_data.findings.publications import publications


def test_the_advice_has_25_paths_for_the_seven_tasks(tables: survey_data.SurveyTables) -> None:
    paths = tables.advice.query("requirement == 'task'")
    # Accuracy: CMOS multi-aperture (geometric, network), encoded (multiplex). Cost: photodiode
    # single-aperture (three models), maskless (two extractors). FOV: photodiode and solar cell
    # maskless by two extractors, encoded. Latency: two detectors by two masks. Power: two
    # detectors. Precision: two models. Volume: two detectors by two extractors.
    assert Counter(paths["value"]) == {
        "Accuracy": 3, "Cost": 5, "FOV": 5, "Latency": 4, "Power": 2, "Precision": 2, "Volume": 4,
    }  # fmt: skip
    for column in ("detector", "mask", "model_category", "extractor"):
        assert paths[column].notna().all()
    assert not paths.drop(columns=["id"]).duplicated().any()
    pairs = set(zip(paths["value"], paths["detector"], paths["mask"], strict=True))
    assert ("Accuracy", "CMOS", "Encoded") in pairs
    assert ("Power", "Event", "Slit") in pairs
    assert not any(mask == "Lens" for _, _, mask in pairs)


def test_the_advice_covers_every_class_and_every_error(tables: survey_data.SurveyTables) -> None:
    advice, taxonomy = tables.advice, tables.taxonomy
    for requirement in ("task", "accuracy", "error"):
        values = set(taxonomy[taxonomy["attribute"] == requirement]["value"]) - {"None"}
        assert set(advice[advice["requirement"] == requirement]["value"]) == values
    finest = advice.query("value == 'UFSS' and mask == 'Multi-Ap.'")
    assert finest["model_category"].isna().all()  # the text names none for it


def test_the_protocol_is_the_survey_s(tables: survey_data.SurveyTables) -> None:
    protocol = tables.protocol
    assert Counter(protocol["kind"]) == {
        "question": 4, "answer": 4, "search": 3, "criterion": 5, "step": 5, "challenge": 5,
    }  # fmt: skip
    found = protocol.set_index(["kind", "id"])["text"]
    assert found["search", "string"] == "sun sensor calibration"
    assert "2002" in found["criterion", "I1"]
    assert "128" in found["step", "5"]


def test_the_middle_ring_has_every_model_once(tables: survey_data.SurveyTables) -> None:
    ring = tables.model_families.set_index("model")["calibration"]
    assert len(ring) == 33 - 1  # all but None
    assert set(ring[ring == "online"].index) == {"ACM", "ECM", "ECM/Noise"}


def test_twelve_methods_were_only_compared(tables: survey_data.SurveyTables) -> None:
    roles = tables.roles
    compared = roles.query("role == 'compared'")
    by_study = compared.groupby("study")["value"].apply(set).to_dict()
    assert by_study == {
        "Chang2006": {"Polynomial"},
        "Chang2007a": {"BCM", "BCTM", "IFM"},
        "Chang2008": {"BCM", "BCTM", "IFM"},
        "Enright2006b": {"PD"},
        "Enright2008b": {"BCM", "PPE"},
        "Faizullin2017": {"Linear"},
        "Pentke2022": {"Polynomial"},
    }
    assert set(roles["role"]) == {"proposed", "compared"}


def test_publications_add_up(tables: survey_data.SurveyTables) -> None:
    found = publications(tables)
    years = {row.value: row.studies for row in found if row.kind == "year"}
    assert sum(years.values()) == 129
    assert years["2001"] == 4  # before the survey's first criterion
    assert (years["2017"], years["2022"], years["2023"]) == (14, 8, 5)
    assert max(years.values()) == years["2017"]
    venues = {row.value: row.studies for row in found if row.kind == "venue"}
    assert sum(venues.values()) == len(tables.venues) <= tables.studies["venue"].notna().sum()
    assert max(venues, key=lambda name: venues[name]) == "Sensors"
    assert venues["IEEE Aerospace Conference"] == 4
    assert not pd.Series(list(venues)).str.contains(r"[0-9]{4}").any()


def test_facts_of_the_same_evidence_are_coded_alike(tables: survey_data.SurveyTables) -> None:
    known = tables.attributes.dropna(subset=["value"])
    has = {
        key: set(map(tuple, rows[["attribute", "value"]].to_numpy()))
        for key, rows in known.groupby("study")
    }
    # Multiple-centroid averaging is defined for masks with several pinholes.
    for key, cells in has.items():
        if ("extractor", "MCAM") in cells:
            assert ("mask", "Multi-Ap.") in cells, key
    # Case studies of a model carry it.
    for key, model in (("Rufino2004a", "LSQ"), ("Fan2013", "Fourier"), ("Faizullin2017", "QPD")):
        assert ("model", model) in has[key]
    # Slit models correct installation and manufacturing.
    for key, cells in has.items():
        if cells & {("model", "Slit"), ("model", "V-Slit")}:
            assert {("error", "Alignment"), ("error", "Manufacturing")} <= cells, key
    # Of the voltage balance alone, nothing else known of the detector: four elements.
    notes = known["note"].fillna("")
    ruled = notes.str.startswith("rule:") & notes.str.contains("voltage balance")
    rule = known[(known["attribute"] == "detector") & ruled]
    assert len(rule) > 5
    for row in rule.itertuples():
        behind_slit = ("mask", "Slit") in has[row.study]
        assert row.value == ("PD" if behind_slit else "QPD")
