"""`sunatlas survey add`, `remove` and `verify`: studies the survey does not map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer

from api.cli.commands.survey_import import ApplyOption, DataOption
from api.cli.table_output import Format, FormatOption, emit, emit_json, say
from api.cli.wrong_call import WrongCallError, only_beside
from files.atomic import replace_file
from survey_data.additions.offered import Addition, FaultsError
from survey_data.additions.template import empty_template, taken_by
from survey_data.additions.writing import (
    add_study,
    choose,
    read_publications,
    read_study,
    remove_study,
    verify_study,
)
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.importing.bibliography import SUFFIXES

_CELLS = ("attribute", "value", "name", "role", "basis", "source", "note")
_PIPELINES = ("detector", "mask", "extractor", "model", "datasets", "assumed")


def add(
    context: typer.Context,
    file: Annotated[Path | None, typer.Argument(help="TOML template of the study.")] = None,
    *,
    init: Annotated[
        str | None,
        typer.Option(
            "--init",
            metavar="KEY",
            help="Write an empty template for this key to FILE, or print it.",
        ),
    ] = None,
    apply: ApplyOption = False,
    data: DataOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Add a study that is not in the survey, with --apply.

    Shows its row, its values and which parts are implemented here. Added studies are kept apart
    from the survey; lists and figures include them with --edition all. Errors in the file are named
    on stderr with line and nearest valid value, and the exit code is 1. `--init KEY FILE.toml`
    writes a template with all allowed values; `--init KEY FILE.bib` (or .ris) prints one with the
    publication filled in.
    """
    folder = data or DATA_DIRECTORY
    if init is not None:
        only_beside(context, "--init", "--data")
        _write_template(init, file, folder)
        return
    if file is None:
        raise WrongCallError("expected a file, or --init KEY for a template")
    try:
        addition = read_study(file, folder)
    except FaultsError as error:
        if form is Format.JSON:
            emit_json({"file": error.file, "faults": [each.to_dict() for each in error.faults]})
        for line in error.lines:
            typer.echo(f"sunatlas: {line}", err=True)
        raise typer.Exit(1) from error
    changed = add_study(addition, folder, apply=apply)
    document = _preview(addition)
    document |= {"tables": sorted(changed), "written": apply}
    if form is Format.JSON:
        emit_json(document)
        return
    if form is Format.CSV:
        emit(document["attributes"], _CELLS, form)
        return
    _print(document)
    if apply:
        typer.echo(f"{addition.key} added; `sunatlas studies {addition.key}` shows it.")
    else:
        typer.echo(f"Nothing written; --apply adds {addition.key}.")


def remove(
    key: Annotated[str, typer.Argument(help="Key of an added study.")],
    *,
    apply: ApplyOption = False,
    data: DataOption = None,
) -> None:
    """Remove an added study and all its values.

    Studies of the survey cannot be removed.
    """
    changed = remove_study(key, data or DATA_DIRECTORY, apply=apply)
    what = f"{key}, from {len(changed)} tables"
    typer.echo(f"Removed {what}." if apply else f"Nothing written; --apply removes {what}.")


def verify(
    key: Annotated[str, typer.Argument(help="Key of a study.")],
    *,
    name: Annotated[str, typer.Option(help="Author of the study who confirmed the values.")],
    confirms: Annotated[str, typer.Option(help="What the author confirmed.")],
    source: Annotated[str, typer.Option(help="Evidence: an address, or a letter and its owner.")],
    date: Annotated[
        str | None, typer.Option(help="Date, YYYY-MM-DD.", show_default="today")
    ] = None,
    apply: ApplyOption = False,
    data: DataOption = None,
) -> None:
    """Record that an author confirmed the values of a study.

    The confirmation is shown on the page of the study and in lists.
    """
    day = date or datetime.now(UTC).date().isoformat()
    row = {"study": key, "name": name, "date": day, "confirms": confirms, "source": source}
    verify_study(row, data or DATA_DIRECTORY, apply=apply)
    said = f"{key}: verified by {name} on {day}: {confirms} ({source})"
    typer.echo(said)
    typer.echo("Written." if apply else "Nothing written; --apply writes it.")


def _write_template(key: str, file: Path | None, folder: Path) -> None:
    """Print an empty template, or write it into a file that is not there yet."""
    digits = "".join(letter for letter in key if letter.isdigit())
    publication = {"key": key, "year": digits}
    if taken := taken_by(key, folder):
        raise WrongCallError(f"--init: {key}: {taken}")
    if file is not None and file.suffix.casefold() in SUFFIXES:
        found = choose(read_publications(file), key, file.name)
        typer.echo(empty_template(folder, found), nl=False)
        return
    text = empty_template(folder, publication)
    if file is None:
        typer.echo(text, nl=False)
        return
    if file.suffix.casefold() != ".toml":
        raise WrongCallError(f"--init: expected a file that ends in .toml; got {file.name!r}")
    if file.exists():
        raise WrongCallError(f"--init: {file} is there already")
    replace_file(file, text)
    typer.echo(f"{file} written: fill it in, then `sunatlas survey add {file}`.")


def _preview(addition: Addition) -> dict[str, Any]:
    """Return the study's row and cells, and what of it would run."""
    from benchmark.plan.combinations import scorable_plan  # noqa: PLC0415 - loads the simulator
    from benchmark.plan.shown import data_sets  # noqa: PLC0415 - as above
    from registry.resolution import resolve  # noqa: PLC0415 - as above
    from registry.studies import study_from  # noqa: PLC0415 - as above

    study = study_from(addition.rows)
    resolution = resolve(study, scorable_plan(), data_sets=data_sets())
    cells = [
        {**cell, "name": _name(cell), "role": cell["role"] if cell["role"] != "unknown" else ""}
        for cell in _cells(study.to_dict())
    ]
    return {
        "study": dict(addition.study),
        "attributes": cells,
        "grade": resolution.fidelity.grade,
        "sentence": resolution.fidelity.sentence,
        "state": resolution.state,
        "pipelines": [pipeline.to_dict() for pipeline in resolution.pipelines],
        "gaps": [gap.to_dict() for gap in resolution.gaps],
    }


def _cells(study: Mapping[str, object]) -> Sequence[Mapping[str, Any]]:
    cells = study["attributes"]
    return cells if isinstance(cells, list) else []


def _name(cell: Mapping[str, Any]) -> str:
    return f"{cell['name_in_study']} (nearest)" if cell["nearest"] else str(cell["name_in_study"])


def _print(document: Mapping[str, Any]) -> None:
    study = document["study"]
    row = [{"column": column, "value": value} for column, value in study.items() if value]
    emit(row, ("column", "value"), Format.TABLE, title=f"Study {study['key']}")
    typer.echo()
    emit(document["attributes"], _CELLS, Format.TABLE, title="Values")
    typer.echo()
    lines = [
        {**p, "assumed": [f"{part}: {rule}" for part, rule in p["assumed"].items()]}
        for p in document["pipelines"]
    ]
    title = f"Implementation here: {document['grade']}; pipelines: {len(lines)}"
    emit(lines, _PIPELINES, Format.TABLE, title=title)
    say(document["sentence"])
    for gap in document["gaps"]:
        say(f"gap: {gap['attribute']} {gap['value']}: {gap['reason']}".replace("  ", " "))
    typer.echo()
