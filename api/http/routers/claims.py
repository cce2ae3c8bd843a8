"""/v1/claims: the survey's statements about algorithms, with verdicts."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query

from api.schema.base import Selected
from api.schema.claims import CheckedRule, ClaimDetail, ClaimRow, Claims, ClaimsQuery
from api.schema.table import columns_of
from api.schema.words import ClaimId
from api.service.pagination import order, page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import AS_ACCEPTED, Known, TableOnly
from benchmark.claims.ledger import Entry, tally

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/claims", summary="Claims of the survey, tested", response_model=Claims | Selected)
async def claims(known: Known, query: Annotated[ClaimsQuery, Query()]) -> Answer:
    """List the claims of the survey about algorithms with their verdicts.

    Each claim is tested with stated criteria; those of eleven were changed after a first result.
    CSV: a row per claim.
    """
    found = [entry for entry in known.measurements.claims.values() if _is_wanted(entry, query)]
    items = order([entry.to_dict() for entry in found], query.sort)
    shown = page(items, "/v1/claims", query)
    counts = tally(found)
    return list_answer(shown, shown.items, columns_of(ClaimRow), fields=query.fields, tally=counts)


@router.get(
    "/claims/{id}",
    summary="A claim",
    response_model=ClaimDetail,
)
async def claim(
    known: Known,
    id: Annotated[ClaimId, Path(description="Claim, such as C29.", examples=["C04"])],  # noqa: A002 - the parameter's name
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Return a claim with its criteria, the results of all trials and its plot.

    CSV: the criteria.
    """
    document = detail(known.measurements.claims[id])
    second = {rule["rule"]: rule["result"] for rule in document["second"]}
    rows = [{**rule, "second_result": second.get(rule["rule"])} for rule in document["rules"]]
    return Answer(document, columns_of(CheckedRule), lambda: rows)


def detail(entry: Entry) -> dict[str, Any]:
    """Return a claim as `GET /v1/claims/{id}` tells it; NaN stands for none."""
    outcome = entry.outcome
    return {
        **entry.to_dict(),
        "how_to_test": entry.claim.how_to_test,
        "values": dict(outcome.values) if outcome else {},
        "second_values": dict(outcome.second) if outcome else {},
        "across": entry.claim.across,
        "up": entry.claim.up,
        "lines": {name: asdict(line) for name, line in outcome.lines.items()} if outcome else {},
    }


def _is_wanted(entry: Entry, query: ClaimsQuery) -> bool:
    if query.verdict and (entry.verdict or "not measured") not in query.verdict:
        return False
    said = entry.claim
    text = f"{said.id} {said.section} {said.study} {said.statement}".casefold()
    return query.q is None or all(word in text for word in query.q.casefold().split())
