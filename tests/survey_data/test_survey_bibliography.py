"""A bibliography is read as printed, compared with ours, and completes identities when asked."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from survey_data import SurveyImportError, import_bibliography, load, validate
from survey_data.importing.bibliography import Entry, read_bibliography

BIB = r"""% the survey's references
@string{jgcd = "Journal of Guidance"}
@comment{Nobody2000, title = {left out}}
@Article{Duan2006,
  author = {Gonz{\'a}lez, Jos\'e and M{\"u}ller-{\O}st, Karl},
  title = {{Sun} Sensor Error \& Compensation -- {CCD}},
  journal = "Acta Test, {T}wo",
  year = 2006, doi = {https://doi.org/10.1234/abc.5}
}
@inproceedings{Fan2017, author={Q. Fan}, title={A Title, With Commas}, year={2017},
  booktitle={Some Conference}}
@article{Chang2008, title = {Another title altogether}, year = {2008}}
@article{Mafi2023, title = {Of another year}, year = {2021}}
@book{Knuth1984, title = {No study}, year = {1984}}
@misc{Herman2025a, title = {The survey's own data}, year = {2025}}
"""


def offer(copy: Any, text: str, name: str = "refs.bib") -> Path:
    path = copy.directory / name
    path.write_text(text, encoding="utf-8")
    return path


def cells(copy: Any, key: str) -> dict[str, str]:
    rows = copy.rows("studies")
    return dict(zip(rows[0], next(row for row in rows if row[0] == key), strict=True))


def test_bibtex_is_read_as_printed(copy: Any) -> None:
    entries = {entry.key: entry for entry in read_bibliography(offer(copy, BIB))}
    assert list(entries) == [
        "Duan2006", "Fan2017", "Chang2008", "Mafi2023", "Knuth1984", "Herman2025a",
    ]  # fmt: skip
    assert entries["Duan2006"] == Entry(
        key="Duan2006",
        title="Sun Sensor Error & Compensation - CCD",
        authors="José González; Karl Müller-Øst",
        year="2006",
        venue="Acta Test, Two",
        kind="journal",
        doi="10.1234/abc.5",
        line=4,
    )
    assert (entries["Fan2017"].title, entries["Fan2017"].kind) == (
        "A Title, With Commas",
        "conference",
    )


def test_a_comparison_shows_what_differs_and_writes_nothing(copy: Any) -> None:
    before = copy.path("studies").read_bytes()
    plan = import_bibliography(offer(copy, BIB), copy.directory)
    assert copy.path("studies").read_bytes() == before
    kinds = {(d.study, d.column): d.kind for d in plan.differences}
    assert kinds["Duan2006", "title"] == kinds["Duan2006", "doi"] == "new"
    assert kinds["Duan2006", "type"] == "new"
    assert kinds["Chang2008", "title"] == "conflict"  # a page has confirmed ours
    assert plan.settled == ("Duan2006", "Fan2017", "Mafi2023")
    assert [aside.key for aside in plan.left_aside] == ["Knuth1984"]
    assert len(plan.missing) == 129 - 4
    assert plan.written == 0


def test_applying_completes_identities_once(copy: Any) -> None:
    path = offer(copy, BIB)
    known = len(load(copy.directory).studies.query("identity == 'confirmed'"))
    plan = import_bibliography(path, copy.directory, apply=True)
    assert (
        plan.written == len(plan.edits) == 11
    )  # five cells of one study, four of another, two of the third
    assert validate(copy.directory) == []
    duan = cells(copy, "Duan2006")
    assert (duan["identity"], duan["type"], duan["doi"]) == (
        "confirmed",
        "journal",
        "10.1234/abc.5",
    )
    assert "(refs.bib)" in duan["note"]
    assert "unknown" in duan["note"]
    assert cells(copy, "Chang2008")["title"] != "Another title altogether"
    assert len(load(copy.directory).studies.query("identity == 'confirmed'")) == known + 3
    after = copy.path("studies").read_bytes()
    again = import_bibliography(path, copy.directory, apply=True)
    assert (again.written, again.settled) == (0, ())
    assert copy.path("studies").read_bytes() == after


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n", "% nothing"])
def test_what_is_no_bibliography_is_refused(copy: Any, text: str) -> None:
    with pytest.raises(SurveyImportError, match=r"refs\.bib holds no entry"):
        import_bibliography(offer(copy, text), copy.directory, apply=True)
    with pytest.raises(SurveyImportError, match="cannot read"):
        import_bibliography(copy.directory / "nowhere.bib")
    (copy.directory / "bad.bib").write_bytes(b"\xff\xfe")
    with pytest.raises(SurveyImportError, match="not UTF-8"):
        import_bibliography(copy.directory / "bad.bib")


@pytest.mark.slow
def test_a_doi_that_is_another_study_s_is_refused_whole(copy: Any) -> None:
    taken = next(row for row in copy.rows("studies") if row[6].startswith("10."))[6]
    before = copy.path("studies").read_bytes()
    text = f"@article{{Fan2017, title={{One}}, doi={{{taken}}}}}"
    with pytest.raises(SurveyImportError, match="would not be valid"):
        import_bibliography(offer(copy, text), copy.directory, apply=True)
    assert copy.path("studies").read_bytes() == before


# A bibliography of every key, made up here with the oddities that real ones have: the known text
# of each field stands beside the LaTeX that is written for it.

ACCENTED = [
    ("José Núñez", r"Jos\'{e} N{\'u}{\~n}ez"),
    ("Zbyněk Čapek", r"Zbyn{\v{e}}k \v{C}apek"),
    ("Łukasz Żak", r"{\L}ukasz {\.Z}ak"),
    ("Åsa Sørensen", r"{\AA}sa S{\o}rensen"),
    ("Gökçe Şahin", r"Gőkçe \c{S}ahin".replace("ő", r"{\"o}")),
]


def made_up(keys: list[str]) -> tuple[str, dict[str, dict[str, str]]]:
    """A .bib of all keys, and what it says of each, in our words."""
    said: dict[str, dict[str, str]] = {}
    parts = [
        "% made up\n",
        '@string{js = "Journal of Suns"}\n@STRING(conf = {Conference on Suns})\n',
        "@comment{@article{Nobody1900, title={No entry}}}\n",
    ]
    for n, key in enumerate(keys):
        year = "".join(c for c in key if c.isdigit())
        name, written = ACCENTED[n % len(ACCENTED)]
        title = f"Sun sensor number {n} \\& its {{CCD}} at 50\\,\\%"
        fields = {"title": f"{{{title}}}", "author": f"{{{written} and Doe, Jane and others}}"}
        want = {
            "title": f"Sun sensor number {n} & its CCD at 50 %",
            "authors": f"{name}; Jane Doe; et al.",
            "year": year,
            "doi": "",
            "url": "",
        }
        form = n % 6
        if form == 0:
            kind, want["type"], want["venue"] = "article", "journal", "Journal of Suns, Part B"
            fields |= {"journal": 'js # ", Part B"', "year": year, "doi": f"{{10.1234/sun.{n}}}"}
            want["doi"] = f"10.1234/sun.{n}"
        elif form == 1:
            kind, want["type"] = "inproceedings", "conference"
            want["venue"] = f"Proceedings of Suns {year}"
            fields |= {"crossref": f"{{proc{n}}}"}
        elif form == 2:
            kind, want["type"], want["venue"] = "misc", "preprint", ""
            fields |= {"eprint": f"{{2001.{n:05d}}}", "archivePrefix": "{arXiv}", "year": year}
            want["doi"] = f"10.48550/arXiv.2001.{n:05d}"
        elif form == 3:
            kind, want["type"], want["venue"] = "phdthesis", "thesis", "University of Suns"
            fields |= {"school": '"University of {S}uns"', "year": f'"{year}"'}
        elif form == 4:
            kind, want["type"], want["venue"] = "InProceedings", "conference", "Conference on Suns"
            fields |= {"booktitle": "conf", "date": f"{{{year}-05-01}}"}
            fields |= {"url": f"{{https://www.mdpi.com/{n}}}"}
            want["url"] = f"https://www.mdpi.com/{n}"
        else:
            kind, want["type"], want["venue"] = "misc", "unknown", ""
            fields = {"title": fields["title"]}  # nothing but a title
            want |= {"authors": ""}
        said[key] = want
        parts.append(f"@{kind}{{{key},\n")
        parts += [f"  {field} = {value},\n" for field, value in fields.items()]
        parts.append("}\n")
        if form == 1:
            parts.append(
                f"@proceedings{{proc{n}, title = {{Proceedings of Suns {year}}}, year = {year}}}\n"
            )
    parts.append(f"@article{{{keys[0]}, title = {{The second of two}}, year = {keys[0][-4:]}}}\n")
    parts.append("@book{Knuth1984, title = {No study}, year = 1984}\n")
    return "".join(parts), said


def test_a_bibliography_of_every_key_completes_every_identity_by_one_call(copy: Any) -> None:
    keys = [row[0] for row in copy.rows("studies")[1:]]
    assert len(keys) == 129
    text, said = made_up(keys)
    before = {key: cells(copy, key) for key in keys}
    path = offer(copy, text)

    shown = import_bibliography(path, copy.directory)
    assert {key: cells(copy, key) for key in keys} == before  # nothing is written yet
    assert shown.missing == ()
    assert shown.conflicts
    assert {keys[0], "Knuth1984"} <= {aside.key for aside in shown.left_aside}

    import_bibliography(path, copy.directory, apply=True)
    assert validate(copy.directory) == []
    for key in keys:
        after = cells(copy, key)
        assert after["identity"] == "confirmed"
        assert after["title"]
        if before[key]["identity"] == "confirmed":  # ours stays where it says something
            kept = {name: text for name, text in before[key].items() if text and name != "type"}
            assert {name: after[name] for name in kept} == kept
            continue
        for column in ("title", "authors", "venue", "doi"):
            expected = said[key][column] or before[key][column]
            assert after[column] == expected, (key, column)
        if said[key]["type"] != "unknown":
            assert after["type"] == said[key]["type"]
        if said[key]["url"] and not before[key]["url"]:
            assert after["url"] == said[key]["url"]


@pytest.mark.slow
def test_a_confirmed_identity_is_replaced_only_by_name(copy: Any) -> None:
    text = "@article{Chang2008, title = {Another title altogether}, year = {2007}}\n"
    path = offer(copy, text)
    plan = import_bibliography(path, copy.directory, apply=True)
    assert [(d.column, d.kind) for d in plan.differences] == [
        *(("title", "conflict"), ("year", "kept"))
    ]
    assert (plan.written, plan.conflicts) == (0, ("Chang2008",))
    plan = import_bibliography(path, copy.directory, replace_studies=["Chang2008"], apply=True)
    assert [(d.column, d.kind) for d in plan.edits] == [("title", "changed")]
    after = cells(copy, "Chang2008")
    assert (after["title"], after["year"]) == ("Another title altogether", "2008")
    assert validate(copy.directory) == []
    with pytest.raises(SurveyImportError, match="says nothing of Liebe2002"):
        import_bibliography(path, copy.directory, replace_studies=["Liebe2002"])


def test_an_address_of_a_mirror_is_not_taken(copy: Any) -> None:
    text = "@misc{Fan2017, title={One}, url={https://www.researchgate.net/p/1}}"
    plan = import_bibliography(offer(copy, text), copy.directory)
    assert "url" not in {d.column for d in plan.differences}


def test_volume_number_and_pages_follow_the_venue(copy: Any) -> None:
    text = """@article{A2000, title={A}, journal={J}, volume=14, number={2}, pages={120--135}}
        @article{B2000, title={B}, journal={J}, volume=3, issue=1, pages={e7}}
        @misc{C2000, title={C}, volume=3}"""
    venues = [entry.venue for entry in read_bibliography(offer(copy, text))]
    assert venues == ["J, vol. 14, no. 2, pp. 120-135", "J, vol. 3, no. 1, e7", ""]


def test_an_entry_of_another_year_than_its_key_is_taken_and_the_year_shown(copy: Any) -> None:
    plan = import_bibliography(offer(copy, BIB), copy.directory, apply=True)
    shown = {
        (d.column, d.kind, d.ours, d.theirs) for d in plan.differences if d.study == "Mafi2023"
    }
    assert shown == {
        ("title", "new", "", "Of another year"),
        ("type", "new", "unknown", "journal"),
        ("year", "kept", "2023", "2021"),
    }
    row = cells(copy, "Mafi2023")
    assert (row["title"], row["year"], row["identity"]) == ("Of another year", "2023", "confirmed")
    assert "which says 2021" in row["note"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("@article{A2000, title={A}, year 2000}", r"refs\.bib, line 1: a broken entry"),
        ('\n@article{A2000, title = "Never', r"line 2: a broken entry .*end of file"),
        ("@article{A2000, title={" + "x" * 20_001 + "}}", "line 1: title is longer than 20000"),
        ("@article{A2000, title=" + "{" * 9000 + "}" * 9000 + "}", "nested too deeply"),
        ('@string{a="x"}' + "@string{a=a#a}\n" * 1000, "line 15: a is longer than 20000"),
        ("@string{a = a # a}\n" * 1000, "a is longer than 20000"),
        ("@misc{a,}\n" * 100_000, r"refs\.bib has more than 10000 entries"),
        ("@misc{a, title={A \u202e B}}", r"'a' holds the character U\+202E"),
        ("@misc{a, title={A \x9b31m B}}", r"'a' holds the character U\+009B"),
        ("@misc{a, title={A}, doi={10.1234/\x9b31m}}", r"'a' holds the character U\+009B"),
        ('@string{a="%s"}' % ("x" * 9000) + "@string{b=a#a#a}", "b is longer than 20000"),
    ],
)
def test_hostile_bibtex_is_refused_by_one_sentence(copy: Any, text: str, said: str) -> None:
    with pytest.raises(SurveyImportError, match=said) as refused:
        read_bibliography(offer(copy, text))
    assert "\n" not in str(refused.value)


def test_a_field_that_stands_twice_counts_once(copy: Any) -> None:
    (entry,) = read_bibliography(offer(copy, "@misc{A2000, title={One}, title={Two}, year=2000}"))
    assert entry.title == "One"


def test_a_percent_sign_in_a_field_starts_no_comment(copy: Any) -> None:
    (entry,) = read_bibliography(offer(copy, "@misc{A2000, title={{S}aves 50% of power}}"))
    assert entry.title == "Saves 50% of power"
