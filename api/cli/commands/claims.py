"""`sunatlas claims`: claims of the survey about algorithms, with verdicts."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.asking import ask
from api.cli.options import Asked, asked_by, complete
from api.cli.table_output import Format, FormatOption, emit, emit_answer, say
from api.cli.wrong_call import WrongCallError
from api.schema import words
from api.schema.claims import ClaimsQuery
from api.service import claims as service
from api.service.documents import Document

RULES_THEN = ("rule", "statistic", "decides", "estimate", "low", "high", "result")
RULES = (*RULES_THEN[:-1], "trials", "result")


@asked_by(ClaimsQuery, "verdict", "q", q="search")
def claims(
    claim: Annotated[
        str | None,
        typer.Argument(
            autocompletion=complete(words.ClaimId),
            metavar="[ID]",
            help="Claim to show in detail, such as C29.",
        ),
    ] = None,
    *,
    asked: Asked,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show claims of the survey, with verdicts.

    Each claim was tested on at least five sensor units or seeds. Reproduced: every criterion holds
    with 95 % confidence. Partly: some hold. Refuted: none holds, and the trial is the case of the
    survey's sentence. Not reproduced here: none holds, on another case. Not testable: the tests
    cannot decide. With an ID, its criteria and results are shown; JSON has every trial. The
    page /claims/ID has its plots, docs/claims.md the method.
    """
    if claim is not None:
        if asked:
            raise WrongCallError("an ID stands alone; leave out --verdict and --search")
        _one(ask(service.claim, id=claim.upper()), form)
        return
    if not asked.get("q", "any").strip():
        raise WrongCallError("--search: got nothing; expected a word or several")
    answer = ask(service.claims, asked)
    document = answer.document
    counts = ", ".join(f"{n} {name}" for name, n in document["tally"].items() if n)
    title = f"{document['total']} claims: {counts or 'none'}"
    rows = [{**item, "claim": item["statement"]} for item in document["items"]]
    emit_answer(answer, form, ("id", "verdict", "claim", "study"), rows=rows, title=title)


def _one(answer: Document, form: Format) -> None:
    document = answer.document
    if form is not Format.TABLE:
        emit_answer(answer, form, ())
        return
    say(f"{document['id']} {document['statement']}", "    ")
    by = f", {document['study']}" if document["study"] else ""
    say(f"The survey, {document['section_name']}{by}, line {document['line']}:")
    say(f"\u201c{document['sentence']}\u201d", "    ")
    say(f"The trial is {document['case']}. {document['reason']}")
    say(f"Tried on {document['measured_on']}; {document['trials']} {document['replicate']}s")
    emit(document["rules"], RULES, form, title=f"Verdict: {document['verdict'] or 'not measured'}")
    if document["second_method"]:
        agreed = {True: "says the same", False: "does not say the same of every rule", None: "-"}
        said = agreed[document["second_agrees"]]
        say(f"Second method: {document['second_method']}: {said}")
    for one in document["former"]:
        say(f"Before criterion or data were changed, on {one['measured_on']}:")
        emit(one["rules"], RULES_THEN, form, title=f"Verdict then: {one['verdict']}")
    if document["explanation"]:
        say(document["explanation"])
