"""Faults of an offered study and of its bibliography are named by line or by item."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from survey_data.additions.offered import FaultsError, parse_toml, read_addition
from survey_data.additions.writing import (
    add_study,
    read_publications,
    read_study,
)
from survey_data.problems import SurveyImportError
from tests.survey_data.additions.offered_study import STUDY, content, line_of, offered, refused

ROLE = 'role = "proposed"'


@pytest.mark.parametrize(
    ("right", "wrong", "at", "said"),
    [
        ('venue = "Journal of Made-up Sensors"', "venue = true", "venue =", "expected a text, got"),
        ('"Jane Doe", ', '"Jane Doe; Max Moe", ', "authors =", "holds a semicolon"),
        (
            'basis = "unknown"',
            'name = "a plate"\nbasis = "unknown"',
            'basis = "unknown"',
            "mask: expected a value, got none",
        ),
        ("value = 0.005", 'value = 0.005\nname = "error"', None, "'accuracy_deg': expected one of"),
        ('"Journal', f'"{"x" * 5001}', "venue =", "venue: longer than 5000 characters"),
        ('basis = "title"', "", None, "basis: expected a value, got none"),
    ],
)  # fmt: skip
def test_a_fault_of_a_template_is_named_by_its_line(
    right: str, wrong: str, at: str | None, said: str
) -> None:
    assert right in STUDY
    text = STUDY.replace(right, wrong, 1)
    ((line, message),) = refused(text)
    assert said in message
    assert at is None or line == line_of(text, at)


def test_a_study_is_added_once(copy: Any) -> None:
    """Two of one key may have been read before either was added."""
    addition = read_study(offered(copy.directory), copy.directory)
    rows = copy.rows("extension_studies")
    added = [addition.study.get(column, "") for column in rows[0]]
    copy.write("extension_studies", [*rows, added])
    before = content(copy.directory)
    with pytest.raises(SurveyImportError, match="a study with the key Doe2030 was added already"):
        add_study(addition, copy.directory, apply=True)
    assert content(copy.directory) == before


def test_a_role_needs_no_reason() -> None:
    text = STUDY.replace('note = "chapter 3"\n', "")
    (role,) = read_addition(parse_toml(text, "study.toml")).rows["roles"]
    assert (role["role"], role["note"]) == ("proposed", "No reason stated.")


@pytest.mark.parametrize("word", ["None", "n/a", "unknown", "not stated"])
def test_what_is_not_stated_is_no_value_and_no_misspelling(word: str) -> None:
    text = STUDY.replace(
        '[[mask]]\nbasis = "unknown"', f'[[mask]]\nvalue = "{word}"\nbasis = "title"'
    )
    ((line, message),) = refused(text)
    assert line == line_of(text, f'value = "{word}"')
    assert message.endswith("; what is not stated has the basis unknown")
    assert "did you mean" not in message


def test_a_publication_of_another_year_than_its_key_is_read_under_its_year(tmp_path: Path) -> None:
    text = "@article{Doe2030, author={Doe, Jane}, title={A}, year={2029}, journal={J}, volume=1}"
    (found,) = publications_of(tmp_path, text, "bib")
    assert (found["key"], found["year"], found["venue"]) == ("Doe2029", "2029", "J, vol. 1")


def test_volume_and_pages_of_ris_follow_the_venue(tmp_path: Path) -> None:
    ris = "TY  - JOUR\nTI  - A\nT2  - J\nVL  - 14\nIS  - 2\nSP  - 120\nEP  - 135\n"
    (found,) = publications_of(tmp_path, ris, "ris")
    assert found["venue"] == "J, vol. 14, no. 2, pp. 120-135"


def test_a_line_without_a_tag_at_the_start_of_a_record_is_refused(tmp_path: Path) -> None:
    text = "TY  - JOUR\nAB  - x\nER  - \nTY  - JOUR\nfoo\nER  - \n"
    with pytest.raises(SurveyImportError, match="starts without a tag"):
        publications_of(tmp_path, text, "ris")


def publications_of(folder: Path, text: str, suffix: str) -> list[dict[str, str]]:
    path = folder / f"refs.{suffix}"
    path.write_text(text, encoding="utf-8")
    return list(read_publications(path))


@pytest.mark.parametrize(
    "text",
    [
        STUDY + '[[model]]\nvalue = "DNN"\n' * 3000,
        "".join(f"k{at} = 1\n" for at in range(3000)) + STUDY,
        STUDY.replace('"Jane Doe"', ", ".join(f'"J. Doe {at}"' for at in range(3000))),
        STUDY + "[[mask]]\n" + "".join(f"k{at} = 1\n" for at in range(3000)),
    ],
)
def test_a_file_of_thousands_of_keys_is_refused_in_one_line(text: str) -> None:
    """Each of them would be a fault with the nearest of all words: 30 s of a file of 1 MB."""
    said = r"^a\.toml: expected at most 2000 keys, tables and names; got [36]\d{3}$"
    with pytest.raises(FaultsError, match=said):
        read_addition(parse_toml(text, "a.toml"))


def test_a_long_key_is_cut_where_it_is_named() -> None:
    for text in ("k" * 9000 + " = 1\n" + STUDY, STUDY + "[[mask]]\n" + "k" * 9000 + " = 1\n"):
        with pytest.raises(FaultsError) as error:
            read_addition(parse_toml(text, "a.toml"))
        assert max(map(len, str(error.value).splitlines())) < 500
