"""Studies read from templates and bibliographies as they were written."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import survey_data
from survey_data.additions.addition_reader import Addition, Row, read_addition
from survey_data.additions.faults import FaultsError
from survey_data.additions.toml_lines import parse_toml
from survey_data.additions.vocabulary import vocabulary
from survey_data.additions.writing import (
    read_study,
)
from survey_data.problems import SurveyImportError
from survey_data.sources import fault
from tests.survey_data.additions.offered_study import content, offered

KNOWN = vocabulary()
WORDS = st.text(st.characters(exclude_categories=("C", "Z")), min_size=1, max_size=8)
TEXT = st.lists(WORDS, min_size=1, max_size=5).map(" ".join)
SOURCE = TEXT.filter(lambda text: not fault(text))


@st.composite
def additions(draw: st.DrawFn) -> Addition:
    known = KNOWN
    study = {
        "key": "Doe2030",
        "title": draw(TEXT),
        "authors": "; ".join(n.replace(";", ",") for n in draw(st.lists(TEXT, max_size=3))),
        "year": "2030",
        "venue": draw(st.one_of(st.just(""), TEXT)),
        "type": draw(st.sampled_from(list(known.words["type"]))),
        "doi": draw(st.sampled_from(["", "10.1234/a(b)c", "10.99999/x;y<z>"])),
        "url": "https://arxiv.org/" + draw(st.sampled_from(["", "a?b=c", "ü"])),
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
            cells = {"basis": basis, "source": draw(SOURCE), "note": draw(TEXT)}
            rows["attributes"].append({**dict.fromkeys(own, ""), **at, **cells})
            if definition.has_names and draw(st.booleans()):
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


PLACE = ("study", "attribute")
#: The escapes of a TOML string are those of JSON.
quoted = partial(json.dumps, ensure_ascii=False)


def by_value(rows: Sequence[Row]) -> dict[tuple[str, str], Mapping[str, str]]:
    return {(row["attribute"], row["value"]): row for row in rows}


def cell(column: str, value: str) -> str:
    if column == "year" and re.fullmatch(r"[1-9][0-9]{0,3}", value):
        return value
    return quoted([n for n in value.split("; ") if n] if column == "authors" else value)


def filled(addition: Addition) -> str:
    """A template that is read into exactly these rows."""
    study = addition.study
    lines = [f"{column} = {cell(column, study[column])}" for column in study if study[column]]
    roles, names = (by_value(addition.rows[table]) for table in ("roles", "names"))
    for row in addition.rows["attributes"]:
        attribute, at = row["attribute"], (row["attribute"], row["value"])
        if not any(row[column] for column in ("value", "source", "note")):
            continue  # unknown, which is said best by saying nothing
        lines += ["", f"[[{attribute}]]"]
        lines += [f"{c} = {quoted(v)}" for c, v in row.items() if v and c not in PLACE]
        if at in names:
            lines.append(f"name = {quoted(names[at]['name'])}")
            lines += ["nearest = true"] * (names[at]["nearest"] == "true")
        if at in roles:
            lines.append(f"role = {quoted(roles[at]['role'])}")
            lines.append(f"role_note = {quoted(roles[at]['note'])}")
    for row in addition.rows["architectures"]:
        lines += ["", "[[architecture]]"]
        lines += [f"{c} = {quoted(v)}" for c, v in row.items() if v and c != "study"]
    return "\n".join(lines) + "\n"


@given(additions())
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_template_gives_back_the_rows_it_was_written_from(addition: Addition) -> None:
    text = filled(addition)
    again = read_addition(parse_toml(text, "study.toml"), KNOWN)
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
