"""Studies after the survey: read from a file or refused by line, added whole, removed traceless."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import survey_data
from survey_data import manifest, recorded_facts
from survey_data.additions.faults import FaultsError
from survey_data.additions.reading import Addition, read_addition
from survey_data.additions.template import empty_template, filled_template
from survey_data.additions.toml_lines import parse_toml
from survey_data.additions.vocabulary import Vocabulary, vocabulary
from survey_data.additions.writing import (
    UnknownStudyError,
    add_study,
    read_study,
    remove_study,
    verify_study,
)
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.editions import EXTENSION_TABLES, editions
from survey_data.problems import SurveyImportError

STUDY = """\
key = "Doe2031a"
title = "A sun sensor that nobody built"
authors = ["Jane Doe", "Łukasz Müller"]
year = 2030
venue = "Journal of Made-up Sensors"
type = "thesis"
doi = "https://doi.org/10.1234/made.up"
identity = "confirmed"

[[model]]
value = "DNN"
name = "graph network"
nearest = true
role = "proposed"
basis = "full-text"
source = "https://example.org/text"
note = "chapter 3"

[[detector]]
value = "CMOS"
basis = "title"

[[mask]]
basis = "unknown"
note = "the text does not say"

[[accuracy_deg]]
value = 0.005
basis = "abstract"
source = "10.1234/made.up"
""".replace("2031a", "2030")

CONFIRMED = {"study": "Doe2030", "name": "Jane Doe", "date": "2030-02-28"}
CONFIRMED |= {"confirms": "every cell", "source": "https://example.org/letter"}


@pytest.fixture(scope="module")
def known() -> Vocabulary:
    return vocabulary()


@pytest.fixture
def recorded(copy: Any) -> Path:
    """A copy of the tables with their manifest."""
    folder: Path = copy.directory
    (folder / manifest.FILE).write_bytes((DATA_DIRECTORY / manifest.FILE).read_bytes())
    return folder


def content(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, hidden ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def offered(folder: Path, text: str = STUDY, name: str = "study.toml") -> Path:
    path = folder.parent / f"{folder.name}-{name}"
    path.write_text(text, encoding="utf-8")
    return path


def refused(known: Vocabulary, text: str) -> list[tuple[int | None, str]]:
    with pytest.raises(FaultsError) as error:
        read_addition(parse_toml(text, "study.toml"), known)
    return [(fault.line, fault.message) for fault in error.value.faults]


def line_of(text: str, words: str) -> int:
    return text[: text.index(words)].count("\n") + 1


def test_a_study_is_added_whole_and_the_survey_stays_as_it_is(recorded: Path) -> None:
    before = content(recorded)
    add_study(read_study(offered(recorded), recorded), recorded, apply=True)
    after = content(recorded)
    assert {name for name in after if after[name] != before[name]} == {
        *(f"extension/{name}.csv" for name in ("studies", "attributes", "roles", "names")),
        manifest.FILE,
    }
    assert survey_data.validate(recorded) == []
    assert recorded_facts.changes(recorded) == []
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


def test_without_apply_nothing_is_written(recorded: Path) -> None:
    before = content(recorded)
    addition = read_study(offered(recorded), recorded)
    assert "extension_studies" in add_study(addition, recorded)
    first = survey_data.load(recorded).extension_studies["key"].iloc[0]
    assert "extension_studies" in remove_study(first, recorded)
    assert set(verify_study({**CONFIRMED, "study": "Chang2008"}, recorded)) == {"verifications"}
    assert content(recorded) == before


def test_a_study_of_the_survey_cannot_be_removed_or_added_again(
    recorded: Path, known: Vocabulary
) -> None:
    with pytest.raises(UnknownStudyError, match="Chang2008 is a study of the survey"):
        remove_study("Chang2008", recorded, apply=True)
    for key, said in (("Chang2008", "of the survey"), ("Herman2025a", "another work")):
        year = key[-4:] if key[-1].isdigit() else key[-5:-1]
        text = STUDY.replace("Doe2030", key).replace("2030", year)
        assert (1, said in refused(known, text)[0][1]) == (refused(known, text)[0][0], True)
    with pytest.raises(UnknownStudyError, match="did you mean Chang2008"):
        verify_study({**CONFIRMED, "study": "Chang208"}, recorded)


@pytest.mark.parametrize(
    ("right", "wrong", "at", "said"),
    [
        ('"CMOS"', '"CMOSS"', '"CMOSS"', r"detector 'CMOSS': expected one of PD, .*mean CMOS\?"),
        ('"CMOS"', '"APS"', '"APS"', r"detector 'APS': .*did you mean CMOS\?"),
        ('"title"', '"titel"', '"titel"', r"basis 'titel': .*did you mean title\?"),
        ('"title"', '"survey-table"', '"survey-table"', "basis 'survey-table': expected one of"),
        ('"thesis"', '"theses"', '"theses"', r"type 'theses': .*did you mean thesis\?"),
        ('"proposed"', '"proposes"', '"proposes"', r"role 'proposes': .*mean proposed\?"),
        ("0.005", "500", "500", "accuracy_deg: expected a number from 1e-06 to 180, got 500"),
        ("0.005", '"5 arcsec"', '"5 arcsec"', "accuracy_deg: expected a number, got '5 arcsec'"),
        ("year = 2030", "year = 2029", "year = 2029", "year 2029: the key Doe2030 says 2030"),
        ("venue =", "venu =", "venu =", r"unknown key 'venu': .*did you mean venue\?"),
        ('basis = "title"', 'base = "title"', "base =", r"unknown key 'base': .*mean basis\?"),
        ('source = "10.1234/made.up"', "", 'basis = "abstract"', "abstract needs a source"),
        ('name = "graph network"', "", "nearest = true", "nearest = true needs a name"),
        ("nearest = true", 'nearest = "yes"', "nearest =", "nearest: expected true or false"),
        ("[[detector]]", "[detector]", "[detector]", r"detector: expected tables \[\[detector\]\]"),
        ('"A sun sensor', '"A \\u0007sun sensor', "title =", r"title: holds the character U\+0007"),
        ("https://doi.org/10.1234/made.up", "made.up", "doi =", "doi: expected a DOI such as"),
    ],
)  # fmt: skip
def test_a_damaged_template_is_refused_by_line(
    known: Vocabulary, right: str, wrong: str, at: str, said: str
) -> None:
    assert right in STUDY
    text = STUDY.replace(right, wrong, 1)
    faults = refused(known, text)
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
def test_what_is_no_toml_is_refused(known: Vocabulary, text: str, line: int | None) -> None:
    (fault,) = refused(known, text)
    assert line is None or fault[0] == line


def test_values_and_evidence_of_one_cell_are_held_together(known: Vocabulary) -> None:
    twice = STUDY + '\n[[detector]]\nvalue = "CMOS"\nbasis = "title"\n'
    assert "stands twice" in refused(known, twice)[0][1]
    beside = STUDY + '\n[[detector]]\nbasis = "unknown"\n'
    assert "unknown beside a value" in refused(known, beside)[0][1]
    single = STUDY + '\n[[accuracy_deg]]\nvalue = 1\nbasis = "title"\n'
    assert "one value at most" in refused(known, single)[0][1]


def test_sensors_of_a_study_use_each_of_its_values(known: Vocabulary, recorded: Path) -> None:
    sensors = (
        STUDY.replace(
            'basis = "unknown"\nnote = "the text does not say"', 'value = "Slit"\nbasis = "title"'
        )
        + '[[mask]]\nvalue = "Lens"\nbasis = "title"\n'
        + '[[detector]]\nvalue = "PDA"\nbasis = "title"\n'
    )
    pair = '[[architecture]]\ndetector = "{}"\nmask = "{}"\nbasis = "title"\n'
    text = sensors + pair.format("CMOS", "Lens")
    assert {message for _, message in refused(known, text)} == {
        "detector 'PDA' is on none of the sensors listed",
        "mask 'Slit' is on none of the sensors listed",
    }
    path = offered(recorded, text + pair.format("PDA", "Slit"))
    add_study(read_study(path, recorded), recorded, apply=True)
    assert len(survey_data.load(recorded).extension_architectures) == 2


def test_an_empty_template_names_every_word_and_is_refused_only_for_what_is_missing(
    known: Vocabulary,
) -> None:
    text = empty_template(known, {"key": "Doe2030", "year": "2030"})
    assert set(tomllib.loads(text)) == {
        *("key", "title", "authors", "year", "venue", "type", "doi", "url", "identity", "note")
    }
    for definition in known.definitions.values():
        assert f"# [[{definition.attribute}]]" in text
        for word, name in definition.words.items():
            assert f"#   {word}" + ("" if word == name else f": {name}") + "\n" in text
    assert [message.partition(":")[0] for _, message in refused(known, text)] == [
        *("title", "type", "doi, url", "identity")
    ]


def test_uncommented_lines_of_an_empty_template_make_a_study(known: Vocabulary) -> None:
    text = empty_template(
        known, {"key": "Doe2030", "year": "2030", "title": "T", "url": "https://x"}
    )
    text = text.replace('type = ""', 'type = "report"').replace(
        'identity = ""', 'identity = "recalled"'
    )
    block = '# [[detector]]\n# value = ""\n# basis = ""\n# source = ""\n# note = ""'
    assert block in text
    filled = '[[detector]]\nvalue = "PD"\nbasis = "title"\n# source = ""\n# note = ""'
    addition = read_addition(parse_toml(text.replace(block, filled), "t"), known)
    assert [r["value"] for r in addition.rows["attributes"] if r["attribute"] == "detector"] == [
        "PD"
    ]


WORDS = st.text(st.characters(exclude_categories=("C", "Z")), min_size=1, max_size=8)
TEXT = st.lists(WORDS, min_size=1, max_size=5).map(" ".join)


@st.composite
def additions(draw: st.DrawFn) -> Addition:
    known = vocabulary()
    study = {
        "key": "Doe2030",
        "title": draw(TEXT),
        "authors": "; ".join(n.replace(";", ",") for n in draw(st.lists(TEXT, max_size=3))),
        "year": "2030",
        "venue": draw(st.one_of(st.just(""), TEXT)),
        "type": draw(st.sampled_from(list(known.words["type"]))),
        "doi": draw(st.sampled_from(["", "10.1234/a(b)c", "10.99999/x;y<z>"])),
        "url": "https://example.org/" + draw(st.sampled_from(["", "a?b=c", "ü"])),
        "identity": draw(st.sampled_from(list(known.words["identity"]))),
        "note": draw(st.one_of(st.just(""), TEXT)),
    }
    rows: dict[str, list[dict[str, str]]] = {
        name: [] for name in ("studies", "roles", "names", "attributes", "architectures")
    }
    rows["studies"].append(study)
    own = [
        f
        for f in survey_data.load().extension_attributes.columns
        if f not in ("study", "attribute")
    ]
    for definition in known.definitions.values():
        attribute = definition.attribute
        allowed = list(definition.words) or ["0.5", "12", "1e-05"]
        if attribute == "fov_deg":
            allowed = ["90", "120.5"]
        most = 3 if definition.multiple else 1
        values = draw(st.lists(st.sampled_from(allowed), max_size=most, unique=True))
        for value in values:
            at = {"study": "Doe2030", "attribute": attribute, "value": value}
            basis = draw(st.sampled_from([b for b in known.bases if b != "unknown"]))
            cells = {"basis": basis, "source": draw(TEXT), "note": draw(TEXT)}
            rows["attributes"].append({**dict.fromkeys(own, ""), **at, **cells})
            if definition.words and draw(st.booleans()):
                nearest = draw(st.sampled_from(["true", "false"]))
                rows["names"].append({**at, "name": draw(TEXT), "nearest": nearest})
            if attribute in ("model", "extractor") and draw(st.booleans()):
                role = {"role": draw(st.sampled_from(list(known.roles)))}
                rows["roles"].append({**at, **role, **cells, "note": draw(TEXT)})
        if not values and definition.complete:
            unknown = {"study": "Doe2030", "attribute": attribute, "basis": "unknown"}
            note = {"note": draw(st.one_of(st.just(""), TEXT))}
            rows["attributes"].append({**dict.fromkeys(own, ""), **unknown, **note})
    return Addition("Doe2030", {name: tuple(found) for name, found in rows.items()})


@given(additions())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_template_gives_back_the_rows_it_was_written_from(
    known: Vocabulary, addition: Addition
) -> None:
    text = filled_template(addition)
    again = read_addition(parse_toml(text, "study.toml"), known)
    assert again == addition


BIBTEX = """@phdthesis{doe, title = {A sun sensor that nobody built}, author = {Doe, Jane and
M{\\"u}ller, Max}, year = 2030, school = {Made-up University}, doi = {10.1234/made.up}}"""
RIS = """TY  - THES
AU  - Doe, Jane
AU  - Müller, Max
TI  - A sun sensor that nobody built
PY  - 2030/01/02
PB  - Made-up University
DO  - 10.1234/made.up
ER  -
"""
CSL = """[{"id": "http://x", "type": "thesis", "title": "A sun sensor that nobody built",
"author": [{"given": "Jane", "family": "Doe"}, {"given": "Max", "family": "Müller"}],
"issued": {"date-parts": [[2030, 1, 2]]}, "publisher": "Made-up University",
"DOI": "10.1234/made.up"}]"""


@pytest.mark.parametrize(("suffix", "text"), [("bib", BIBTEX), ("ris", RIS), ("json", CSL)])
def test_a_publication_is_read_from_each_kind_of_bibliography(
    recorded: Path, suffix: str, text: str
) -> None:
    path = offered(recorded, text, f"refs.{suffix}")
    study = read_study(path, recorded).study
    assert study == {
        "key": "Doe2030",
        "title": "A sun sensor that nobody built",
        "authors": "Jane Doe; Max Müller",
        "year": "2030",
        "venue": "Made-up University",
        "type": "thesis",
        "doi": "10.1234/made.up",
        "url": "",
        "identity": "confirmed",
        "note": "",
    }
    path.with_suffix(".toml").write_text('[[task]]\nvalue = "Power"\nbasis = "title"\n')
    cells = read_study(path, recorded).rows["attributes"]
    assert [row["value"] for row in cells if row["attribute"] == "task"] == ["Power"]


def test_ris_is_read_as_rispy_reads_it(recorded: Path) -> None:
    rispy = pytest.importorskip("rispy")
    (theirs,) = rispy.loads(RIS)
    study = read_study(offered(recorded, RIS, "refs.ris"), recorded).study
    natural = [" ".join(reversed(name.split(", "))) for name in theirs["authors"]]
    assert study["authors"] == "; ".join(natural)
    assert (study["title"], study["doi"]) == (theirs["title"], theirs["doi"])


def test_one_of_several_publications_is_chosen_by_its_key(recorded: Path) -> None:
    other = BIBTEX.replace("{doe,", "{roe,").replace("Jane", "Ann").replace("made.up", "other")
    path = offered(recorded, BIBTEX + "\n" + other.replace("Doe,", "Roe,"), "refs.bib")
    with pytest.raises(FaultsError, match=r"choose one with --key \(Doe2030, Roe2030\)"):
        read_study(path, recorded)
    assert read_study(path, recorded, key="Roe2030").study["doi"] == "10.1234/other"
    with pytest.raises(FaultsError, match="did you mean Roe2030"):
        read_study(path, recorded, key="Row2030")


@pytest.mark.parametrize("text", ["", "{", '{"a": 1}', "[1]", "TY  - JOUR\n", "\x00\xff", "@x{,}"])
@pytest.mark.parametrize("suffix", ["bib", "ris", "json", "toml", "pdf"])
def test_what_is_no_study_is_refused(recorded: Path, suffix: str, text: str) -> None:
    before = content(recorded)
    with pytest.raises(SurveyImportError):
        read_study(offered(recorded, text, f"refs.{suffix}"), recorded)
    assert content(recorded) == before


def test_a_confirmation_stands_once_and_on_a_real_day(recorded: Path) -> None:
    row = {**CONFIRMED, "study": "Chang2008"}
    verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="stands already"):
        verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="expected a day, got '2030-02-30'"):
        verify_study({**row, "date": "2030-02-30"}, recorded, apply=True)


KILLED = """
import os, sys
from pathlib import Path
from survey_data.additions import writing
count, folder, path = int(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
import survey_data.whole_files as whole
def counted(real):
    def step(*given, **more):
        global count
        if any(str(each).startswith(str(folder)) for each in given):
            count -= 1
            if count == 0:
                os.kill(os.getpid(), 9)
        return real(*given, **more)
    return step
for name in ("replace", "rename", "unlink", "rmdir", "mkdir"):
    setattr(os, name, counted(getattr(os, name)))
whole.exchange = counted(whole.exchange)
writing.add_study(writing.read_study(path, folder), folder, apply=True)
"""


@pytest.mark.slow
def test_a_kill_between_any_two_steps_leaves_the_study_whole_or_away(recorded: Path) -> None:
    path = offered(recorded)
    begun = content(recorded)
    seen = set()
    for step in range(1, 60):
        root = str(Path(__file__).parents[2])
        ran = subprocess.run(
            [sys.executable, "-c", KILLED, str(step), str(recorded), str(path)],
            env={**os.environ, "PYTHONPATH": root},
            capture_output=True,
            check=False,
        )
        assert ran.returncode in (0, -signal.SIGKILL), ran.stderr
        assert recorded_facts.changes(recorded) == []
        assert survey_data.validate(recorded) == []
        tables = survey_data.load(recorded)
        there = "Doe2030" in set(tables.extension_studies["key"])
        seen.add((there, ran.returncode))
        assert (tables.extension_attributes["study"] == "Doe2030").any() == there
        if there:
            remove_study("Doe2030", recorded, apply=True)
        else:  # what was left is cleared by the next that writes
            addition = read_study(path, recorded)
            add_study(addition, recorded, apply=True)
            remove_study("Doe2030", recorded, apply=True)
        assert content(recorded) == begun
        if ran.returncode == 0:
            break
    assert seen >= {(False, -signal.SIGKILL), (True, -signal.SIGKILL), (True, 0)}


def test_an_edition_has_another_version_when_a_cell_of_it_changes(recorded: Path) -> None:
    survey, later = editions(recorded)
    assert (survey.studies, later.studies) == (
        129,
        len(survey_data.load(recorded).extension_studies),
    )
    add_study(read_study(offered(recorded), recorded), recorded, apply=True)
    again, more = editions(recorded)
    assert again == survey
    assert more.studies == later.studies + 1
    assert more.version != later.version


@pytest.mark.parametrize(
    ("table", "column", "text", "said"),
    [
        ("extension_studies", "key", "Chang2008", "a study of the survey"),
        ("extension_studies", "doi", "10.1016/j.sna.2006.05.037", "Chang2006 of the survey"),
        ("extension_studies", "year", "1999", "the key"),
        ("extension_attributes", "value", "Sundial", "unknown taxonomy value"),
        ("extension_attributes", "basis", "survey-text", "of a study after the survey"),
        ("extension_roles", "value", "Fourier", "has no"),
        ("extension_names", "value", "Fourier", "has no"),
    ],
)
def test_rules_hold_for_later_studies_and_name_their_file(
    copy: Any, table: str, column: str, text: str, said: str
) -> None:
    copy.set(table, 2, column, text)
    name = f"extension/{table.removeprefix('extension_')}.csv"
    assert any(p.row == 2 and said in p.message for p in copy.found(name)), copy.found(name)


@pytest.mark.parametrize("table", EXTENSION_TABLES)
def test_a_missing_or_damaged_table_of_later_studies_is_named(copy: Any, table: str) -> None:
    path = copy.path(table)
    right = path.read_bytes()
    path.write_bytes(right.replace(b",", b"_", 1))
    name = path.relative_to(copy.directory).as_posix()
    assert {p.file for p in survey_data.validate(copy.directory)} == {name}
    path.unlink()
    expected = survey_data.Problem(name, None, None, "the file is missing")
    assert expected in survey_data.validate(copy.directory)


def test_tables_of_later_studies_have_the_columns_of_the_surveys() -> None:
    tables = survey_data.load()
    for name in ("studies", "attributes", "roles", "architectures"):
        later = getattr(tables, f"extension_{name}")
        assert list(later.columns) == list(getattr(tables, name).columns)
