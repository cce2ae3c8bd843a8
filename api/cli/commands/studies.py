"""`sunatlas studies`: the mapped studies and what of each can be run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any

import typer

from api.citations import FORMS
from api.cli.asking import ask, knowledge
from api.cli.options import Asked, asked_by, complete
from api.cli.table_output import Format, emit, emit_json, say, write
from api.cli.wrong_call import WrongCallError, only_beside
from api.schema import words
from api.schema.parameters import LARGEST_PAGE
from api.schema.studies import AttributeValue, StudiesQuery, StudyRow
from api.schema.table import columns_of
from api.service import studies as service
from benchmark.leaderboard.board import NOMINAL
from benchmark.leaderboard.summaries import digits
from registry.fidelity.grading import tally_text
from registry.taxonomy import ATTRIBUTES
from survey_data import labels

COLUMNS = ("key", "year", "grade", "detector", "mask", "extractor", "model", "title")
OWN = "own error"
DETAILS = (
    *("attribute", "value", "name_in_study", "nearest", "role", "basis", "source_name", "note"),
)


class StudyFormat(StrEnum):
    """How studies are printed."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"
    BIBTEX = "bibtex"
    RIS = "ris"
    CSL = "csl"


@asked_by(StudiesQuery, *ATTRIBUTES, "grade", "state", "edition", "year_min", "year_max", "q")
def studies(
    context: typer.Context,
    key: Annotated[
        str | None,
        typer.Argument(
            autocompletion=complete(words.StudyKey),
            help="Study to show in detail, such as Chang2008.",
        ),
    ] = None,
    *,
    asked: Asked,
    form: Annotated[
        StudyFormat,
        typer.Option(
            "--format",
            help="Output format; bibtex, ris and csl (JSON) are references to studies with a "
            "known title.",
        ),
    ] = StudyFormat.TABLE,
    published: Annotated[
        bool,
        typer.Option(
            "--published", help="Compare reported accuracies with own errors here, worst first."
        ),
    ] = False,
) -> None:
    """List studies with the grade of each run, or show one.

    Grades: faithful (sensor, condition, methods, calibration and score are the study's own),
    assumed (nothing known differs, but facts that it takes to judge are unknown), close (one part
    differs), stand-in (more parts differ), none (not implemented). `sunatlas studies KEY` shows
    what differs or is unknown, what would raise the grade, and the basis of each value. State is
    complete if every value of the study is implemented. --published compares the accuracy that
    studies report with the own error here, worst first.
    """
    if published and (key is not None or form in FORMS):
        raise WrongCallError("--published compares every study of the survey, as a table")
    if published:
        only_beside(context, "--published", "--format", "--safe")
        rows = service.compare_accuracy(knowledge())
        title = service.say_comparison(rows)
        emit(rows, service.COMPARED, Format(form), document=rows, title=title)
    elif key is None:
        _list(asked, form)
    else:
        only_beside(context, "a study's key", "--format", "--safe")
        _show(key, form)


def _list(filters: Mapping[str, Any], asked: StudyFormat) -> None:
    found = ask(service.studies, {**filters, "limit": LARGEST_PAGE}).document["items"]
    if asked in FORMS:
        _cite(found, asked)
        return
    form = Format(asked)
    flat = [{**study, **study["values"]} for study in found]
    columns = columns_of(StudyRow) if form is Format.CSV else COLUMNS
    counted = tally_text(study["grade"] for study in found)
    emit(flat, columns, form, document=found, title=f"{len(found)} studies: {counted}")


def _cite(found: Sequence[Mapping[str, Any]], asked: StudyFormat) -> None:
    """Print references, and on stderr which studies have none because nobody identified them."""
    write(FORMS[asked](found))
    without = [study["key"] for study in found if not study["title"]]
    if without:
        typer.echo(f"sunatlas: no title is known of {', '.join(without)}: left out", err=True)


def _show(key: str, asked: StudyFormat) -> None:
    study = ask(service.study, key=key).document
    if asked in FORMS:
        _cite([study], asked)
        return
    form = Format(asked)
    if form is Format.JSON:
        emit_json(study)
        return
    if form is Format.TABLE:
        say(f"{study['key']}: {study['title'] or 'title unknown'}")
        year = study["year"] or "year unknown"
        say(f"{study['authors'] or 'authors unknown'}, {year}. {study['venue'] or ''}")
        say(study["doi"] or study["url"] or "no DOI known")
        if study["edition"] != "survey":
            say("Not mapped by the survey.")
        for one in study["verified"]:
            say(f"Verified by {one['name']} on {one['date']}: {one['confirms']} ({one['source']})")
        say(f"{study['grade']}: {labels.label_of(study['sentence'])}")
        for departure in study["departures"]:
            way = "unknown" if departure["unknown"] else "differs"
            say(f"  {departure['part']} {way}; raised by: {departure['settled_by']}")
        if own := study["own_sensor"]:
            say(f"Its sensor here: {labels.label_of(own)}")
        typer.echo()
    emit(study["attributes"], columns_of(AttributeValue) if form is Format.CSV else DETAILS, form)
    if form is Format.TABLE:
        reported = [study[f"reported_{quantity}"] for quantity in ("accuracy", "precision")]
        said = [
            f"{digits(one['rms_deg'])} deg RMS ({one['value_deg']:g} deg, {one['label']})"
            for one in reported
            if one is not None
        ]
        typer.echo()
        say(f"Reported by the study of its own sensor: {', '.join(said) or 'no number is known'}")
        for line in _rungs(study["ladder"]):
            say(line)
        typer.echo()
        pipelines = (*("detector", "mask", "extractor", "model", OWN), "assumed")
        emit(
            [{**p, OWN: _measure(p), "assumed": _assume(p)} for p in study["pipelines"]],
            *(pipelines, form),
            title=f"Runs: {len(study['pipelines'])}",
        )
        typer.echo()
        gaps = ("attribute", "value", "reason")
        emit(study["gaps"], gaps, form, title=f"Gaps: {len(study['gaps'])}")


def _rungs(ladder: Mapping[str, Any] | None) -> Iterator[str]:
    """Give a line for each rung below a study's reported figure."""
    if ladder is None:
        yield "Its own method here, the best method and the bound: not known"
        return
    label = OWN if ladder["nominal"] else "RMS over units"
    yield f"Here, on {ladder['dataset']}, {ladder['condition']}:"
    for name, rung in (("its own method", ladder["own"]), ("best method", ladder["best"])):
        yield (
            f"  {name}: {label} {digits(rung['own_error_deg'])} deg, {rung['extractor']} + "
            f"{rung['model']}"
        )
    yield (
        f"  bound: {digits(ladder['bound_deg'])} deg with the unit known, "
        f"{digits(ladder['bound_unit_deg'])} deg with the unit known only through its calibration"
    )


def _assume(pipeline: Mapping[str, Any]) -> list[str]:
    """Return a line for each part of a pipeline that the study does not state."""
    return [
        f"{attribute} ({pipeline['basis'][attribute]}): {labels.label_of(rule)}"
        for attribute, rule in pipeline["assumed"].items()
    ]


def _measure(pipeline: Mapping[str, Any]) -> list[str]:
    """Return each setting of a pipeline with its own error there."""
    return [
        f"{score['dataset']}, {score['condition']}: {_error(score)}" for score in pipeline["scores"]
    ]


def _error(score: Mapping[str, Any]) -> str:
    if score["own_error_deg"] is not None:
        alone = "" if score["condition"] == NOMINAL else " (RMS over units)"
        return f"{digits(score['own_error_deg'])} deg{alone}"
    return "not measured yet" if score["status"] is None else "without an error"
