"""`sunatlas directions`: the survey's future directions, with verdicts."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.asking import ask
from api.cli.table_output import Format, FormatOption, emit, emit_answer, say
from api.schema.directions import DirectionDuel, SpoofedSensor
from api.schema.table import columns_of
from api.service.directions import directions as service
from survey_data.nearest import nearest_name

#: Of a sensor with a laser beside it, what a table has room for; CSV and JSON have everything.
_OF_SENSORS = (
    "dataset", "extractor", "readings", "deceived", "noticed", "noticed_low", "clean",
    "false_alarms",
)  # fmt: skip


def directions(
    direction: Annotated[
        str | None, typer.Argument(metavar="[ID]", help="Direction to show in detail, such as D05.")
    ] = None,
    *,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show the survey's future directions, with verdicts.

    Each has a rule that was written down before its outcome: two families of methods on the data
    sets of the record, or a calculation. With an ID, its rule and what each data set says.
    """
    answer = ask(service)
    document = answer.document
    if direction is None:
        emit_answer(answer, form, ("id", "verdict", "question"), title=document["words"])
        return
    found = {one["id"]: one for one in document["items"]}
    one = found.get(direction.upper())
    if one is None:
        near = nearest_name(direction.upper(), tuple(found))
        hint = f"; did you mean {near}?" if near else f"; known: {', '.join(found)}"
        raise typer.BadParameter(f"no direction {direction!r}{hint}")
    rows, columns = one["duels"], columns_of(DirectionDuel)
    if one["sensors"]:
        rows, columns = one["sensors"], columns_of(SpoofedSensor)
        if form is Format.TABLE:
            columns = _OF_SENSORS
    emit(rows, columns, form, document=one, title=one["question"])
    if form is Format.TABLE:
        for text in (one["text"], f"Verdict: {one['verdict']}.", one["rule"]):
            say(text)
