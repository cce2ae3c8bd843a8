"""Studies the survey does not map: read or refused by line, added whole, removed traceless."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import survey_data
from files import manifest
from survey_data import facts_manifest
from survey_data.additions.offered import FaultsError, parse_toml, read_addition
from survey_data.additions.template import empty_template
from survey_data.additions.writing import (
    UnknownStudyError,
    add_study,
    read_study,
    remove_study,
    verify_study,
)
from tests.survey_data.additions.offered_study import (
    CONFIRMED,
    STUDY,
    content,
    line_of,
    offered,
    refused,
)


def test_a_study_is_added_whole_and_the_survey_stays_as_it_is(recorded: Path) -> None:
    before = content(recorded)
    add_study(read_study(offered(recorded), recorded), recorded, apply=True)
    after = content(recorded)
    assert {name for name in after if after[name] != before[name]} == {
        *(f"extension/{name}.csv" for name in ("studies", "attributes", "roles", "names")),
        manifest.FILE,
    }
    assert survey_data.validate(recorded) == []
    assert facts_manifest.changes(recorded) == []
    tables = survey_data.load(recorded)
    assert len(tables.studies) == survey_data.fidelity(tables).studies == 129
    every = tables.edition("all").studies.set_index("key")
    assert every.loc["Doe2030", ["edition", "type", "doi"]].tolist() == [
        *("extension", "thesis", "10.1234/made.up")
    ]
    assert (every.loc[tables.studies["key"], "edition"] == "survey").all()


def test_what_is_left_out_is_unknown(recorded: Path) -> None:
    addition = read_study(offered(recorded), recorded)
    rows = {row["attribute"]: row for row in addition.rows["attributes"]}
    assert rows["task"] | {"study": ""} == {
        **dict.fromkeys(rows["task"], ""),
        "attribute": "task",
        "basis": "unknown",
    }
    assert rows["mask"]["note"] == "the text does not say"
    assert "fov_deg" not in rows  # not every study states one


def test_adding_and_removing_leaves_no_trace(recorded: Path) -> None:
    before = content(recorded)
    add_study(read_study(offered(recorded), recorded), recorded, apply=True)
    verify_study(CONFIRMED, recorded, apply=True)
    assert "Jane Doe" in content(recorded)["extension/verifications.csv"].decode()
    remove_study("Doe2030", recorded, apply=True)
    assert content(recorded) == before


@pytest.mark.slow
def test_without_apply_nothing_is_written(recorded: Path) -> None:
    before = content(recorded)
    addition = read_study(offered(recorded), recorded)
    assert "extension_studies" in add_study(addition, recorded)
    first = survey_data.load(recorded).extension_studies["key"].iloc[0]
    assert "extension_studies" in remove_study(first, recorded)
    assert set(verify_study({**CONFIRMED, "study": "Chang2008"}, recorded)) == {"verifications"}
    assert content(recorded) == before


def test_a_study_of_the_survey_cannot_be_removed_or_added_again(recorded: Path) -> None:
    with pytest.raises(UnknownStudyError, match="Chang2008"):
        remove_study("Chang2008", recorded, apply=True)
    for key, said in (("Chang2008", "of the survey"), ("Herman2025a", "survey cites")):
        year = key[-4:] if key[-1].isdigit() else key[-5:-1]
        text = STUDY.replace("Doe2030", key).replace("2030", year)
        assert (1, said in refused(text)[0][1]) == (refused(text)[0][0], True)
    with pytest.raises(UnknownStudyError, match="did you mean Chang2008"):
        verify_study({**CONFIRMED, "study": "Chang208"}, recorded)


@pytest.mark.parametrize(
    ("right", "wrong", "at", "said"),
    [
        ('"CMOS"', '"CMOSS"', '"CMOSS"', r"'CMOSS' of detector: .*\bPD, .* CMOS\?"),
        ('"CMOS"', '"APS"', '"APS"', r"'APS' of detector: .*did you mean CMOS\?"),
        ('"title"', '"titel"', '"titel"', r"basis: 'titel': .*did you mean title\?"),
        ("0.005", "500", "500", r"accuracy_deg: .*\b1e-06\b.*\b180\b.*\b500\b"),
        ('venue = "Journal', 'venue = nan # "', "venue =", "expected a text"),
        ("venue =", "venu =", "venu =", r"key 'venu': .*\bvenue\?"),
        ('basis = "title"', 'base = "title"', "base =", r"unknown key 'base': .*mean basis\?"),
        ('name = "graph network"', "", "nearest = true", "nearest: needs a name"),
        ("nearest = true", 'nearest = "yes"', "nearest =", "nearest: expected true or false"),
        ("https://arxiv.org", "https://scribd.com", "https://scribd", "source: .*document sharing"),
        ("[[detector]]", "[detector]", "[detector]", r"detector: expected tables \[\[detector\]\]"),
        ('"A sun sensor', '"A \\u0007sun sensor', "title =", r"title: holds the character U\+0007"),
        ('"A sun sensor', '"A \\u202esun sensor', "title =", r"title: holds the character U\+202E"),
    ],
)  # fmt: skip
def test_a_damaged_template_is_refused_by_line(right: str, wrong: str, at: str, said: str) -> None:
    assert right in STUDY
    text = STUDY.replace(right, wrong, 1)
    faults = refused(text)
    assert any(
        line == line_of(text, at) and re.search(said, message) for line, message in faults
    ), faults


def test_every_fault_is_listed_in_the_order_of_lines(recorded: Path) -> None:
    text = STUDY.replace('"CMOS"', '"CMOSS"').replace('"thesis"', '"theses"').replace("0.005", "-1")
    path = offered(recorded, text)
    before = content(recorded)
    with pytest.raises(FaultsError) as error:
        read_study(path, recorded)
    lines = str(error.value).splitlines()
    assert [re.findall(r"line (\d+)", each) for each in lines] == [
        [str(line_of(text, words))] for words in ('"theses"', '"CMOSS"', "-1")
    ]
    assert all(each.startswith(f"{path.name}, line ") for each in lines)
    assert content(recorded) == before


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (STUDY.replace('title = "A', "title = A"), 2),
        (STUDY + "[[model\n", STUDY.count("\n") + 1),
        (STUDY + 'note = """\n', None),
        ("x = " + "9" * 5000, None),
        ("x = " + "[" * 3000, None),
    ],
)
def test_what_is_no_toml_is_refused(text: str, line: int | None) -> None:
    (fault,) = refused(text)
    assert line is None or fault[0] == line


def test_values_and_evidence_of_one_cell_are_held_together() -> None:
    twice = STUDY + '\n[[detector]]\nvalue = "CMOS"\nbasis = "title"\n'
    assert "stands already in line 19" in refused(twice)[0][1]
    beside = STUDY + '\n[[detector]]\nbasis = "unknown"\n'
    assert "unknown beside a value" in refused(beside)[0][1]
    single = STUDY + '\n[[accuracy_deg]]\nvalue = 1\nbasis = "title"\n'
    assert "which admits one" in refused(single)[0][1]


def test_sensors_of_a_study_use_each_of_its_values(recorded: Path) -> None:
    sensors = (
        STUDY.replace(
            'basis = "unknown"\nnote = "the text does not say"', 'value = "Slit"\nbasis = "title"'
        )
        + '[[mask]]\nvalue = "Lens"\nbasis = "title"\n'
        + '[[detector]]\nvalue = "PDA"\nbasis = "title"\n'
    )
    pair = '[[architecture]]\ndetector = "{}"\nmask = "{}"\nbasis = "title"\n'
    text = sensors + pair.format("CMOS", "Lens")
    on_none = "{0}: Doe2030 has the {0} {1!r} on none of its sensors"
    assert [message for _, message in refused(text)] == [
        on_none.format("detector", "PDA"),
        on_none.format("mask", "Slit"),
    ]
    path = offered(recorded, text + pair.format("PDA", "Slit"))
    add_study(read_study(path, recorded), recorded, apply=True)
    assert len(survey_data.load(recorded).extension_architectures) == 2


def test_an_empty_template_names_every_word_and_is_refused_only_for_what_is_missing() -> None:
    text = empty_template(publication={"key": "Doe2030", "year": "2030"})
    assert set(tomllib.loads(text)) == {
        *("key", "title", "authors", "year", "venue", "type", "doi", "url", "identity", "note")
    }
    tables = survey_data.load()
    for attribute in tables.attribute_definitions["attribute"]:
        assert f"# [[{attribute}]]" in text
    for word, name in zip(tables.taxonomy["value"], tables.taxonomy["name"], strict=True):
        assert f"#   {word}" + ("" if word == name else f": {name}") + "\n" in text
    assert [message.partition(":")[0] for _, message in refused(text)] == [
        *("url", "title", "type", "identity")
    ]


def test_uncommented_lines_of_an_empty_template_make_a_study() -> None:
    text = empty_template(
        publication={
            "key": "Doe2030",
            "year": "2030",
            "title": "T",
            "url": "https://arxiv.org/abs/2030.00001",
        }
    )
    text = text.replace('type = ""', 'type = "report"').replace(
        'identity = ""', 'identity = "recalled"'
    )
    block = '# [[detector]]\n# value = ""\n# basis = ""\n# source = ""\n# note = ""'
    assert block in text
    filled = '[[detector]]\nvalue = "PD"\nbasis = "title"\n# source = ""\n# note = ""'
    addition = read_addition(parse_toml(text.replace(block, filled), "t"))
    assert [r["value"] for r in addition.rows["attributes"] if r["attribute"] == "detector"] == [
        "PD"
    ]
