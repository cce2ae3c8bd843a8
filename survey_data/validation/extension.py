"""Rules of studies the survey does not map: those of its own, and what keeps the two apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from datetime import date

from survey_data.descriptor import file_name
from survey_data.editions import BY_STUDY
from survey_data.problems import Problem
from survey_data.validation.cells import Frames, Rule, cells_of, foreign, of_study, problem, texts

#: Tables that a rule of studies may look at beside those of the edition.
SHARED = frozenset(
    {"taxonomy", "attribute_definitions", "aliases", "bases", "statistics", "sources", "labels"}
)
#: Evidence that only the survey, or its authors' own table, gives.
SURVEY_BASES = ("survey-table", "authors-table", "survey-text")


def check_extension(
    frames: Frames, rules: tuple[tuple[tuple[str, ...], Rule], ...]
) -> list[Problem]:
    """Return the problems of studies the survey does not map.

    Those of its rules that ask for nothing but studies and vocabulary hold for these too.
    """
    later = {name: frames[name] for name in SHARED if name in frames}
    for name in BY_STUDY:
        if f"extension_{name}" in frames:
            later[name] = frames[f"extension_{name}"]
    own = {file_name(name): file_name(f"extension_{name}") for name in BY_STUDY}
    found = [
        replace(each, file=own.get(each.file, each.file))
        for needed, rule in rules
        if needed and {*needed} <= SHARED | {*BY_STUDY} and {*needed} & {*BY_STUDY}
        if all(name in later for name in needed)
        for each in rule(later)
    ]
    return found + [
        each
        for needed, rule in _RULES
        if all(name in frames for name in needed)
        for each in rule(frames)
    ]


def _keys_are_new(frames: Frames) -> Iterator[Problem]:
    """Check that a study has neither the key nor the DOI of another."""
    known: dict[str, str] = {}
    for _, (key, doi) in texts(frames["studies"], "key", "doi"):
        known |= {key.casefold(): "a study of the survey", doi.casefold(): f"{key} of the survey"}
    for _, (key,) in texts(frames["references"], "key"):
        known[key.casefold()] = "a key that the survey cites"
    known.pop("", None)
    columns = ("key", "doi")
    for index, cells in texts(frames["extension_studies"], *columns):
        for column, cell in zip(columns, cells, strict=True):
            if cell.casefold() in known:
                message = f"{cell} is {known[cell.casefold()]}"
                yield problem("extension_studies", index, column, message)


def _rests_on_its_own(frames: Frames) -> Iterator[Problem]:
    """Check that nothing of such a study rests on the survey."""
    for name in BY_STUDY[1:]:
        table = f"extension_{name}"
        if table not in frames:
            continue
        for index, (basis,) in texts(frames[table], "basis"):
            if basis in SURVEY_BASES:
                yield problem(table, index, "basis", f"{basis}, of a study outside the survey")


def _names_are_of_values(frames: Frames) -> Iterator[Problem]:
    """Check that a name is of one of the study's values."""
    own = {**frames, "attributes": frames["extension_attributes"]}
    yield from of_study(own, "extension_names", "", ("value",))


def _verified_studies_exist(frames: Frames) -> Iterator[Problem]:
    """Check that a confirmation is of a study of either edition, on a day that there is."""
    known = cells_of(frames, "studies", "key") | cells_of(frames, "extension_studies", "key")
    yield from foreign(frames, "verifications", "study", known, "no study {!r}")
    for index, (day,) in texts(frames["verifications"], "date"):
        try:
            date.fromisoformat(day)
        except ValueError:
            yield problem("verifications", index, "date", f"expected a day, got {day!r}")


_RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("studies", "references", "extension_studies"), _keys_are_new),
    (("extension_attributes",), _rests_on_its_own),
    (("extension_attributes", "extension_names"), _names_are_of_values),
    (("studies", "extension_studies", "verifications"), _verified_studies_exist),
)
