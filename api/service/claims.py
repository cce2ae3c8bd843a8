"""The survey's statements about algorithms, with verdicts."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from api.schema.claims import CheckedRule, ClaimRow, ClaimsQuery
from api.schema.table import columns_of
from api.schema.words import ClaimId
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge
from benchmark.claims.ledger import Entry, tally


def claims(known: Knowledge, query: ClaimsQuery) -> Document:
    """List claims of the survey with their verdicts.

    CSV: a row per claim.
    """
    found = [entry for entry in known.measurements.claims.values() if _is_wanted(entry, query)]
    items = [entry.to_dict() for entry in found]
    return listing(items, "/v1/claims", query, ClaimRow, tally=tally(found))


def claim(known: Knowledge, id: ClaimId) -> Document:  # noqa: A002 - the parameter's name
    """Return a claim with its criteria, the results of all trials and its plot.

    CSV: the criteria.
    """
    document = detail(known.measurements.claims[id])
    second = {rule["rule"]: rule["result"] for rule in document["second"]}
    rows = [{**rule, "second_result": second.get(rule["rule"])} for rule in document["rules"]]
    return Document(document, columns_of(CheckedRule), lambda: rows)


def detail(entry: Entry) -> dict[str, Any]:
    """Return a claim as `GET /v1/claims/{id}` tells it; NaN stands for none."""
    outcome = entry.outcome
    return {
        **entry.to_dict(),
        "sentence": entry.review.quotation,
        "line": int(entry.review.line),
        "reason": entry.review.reason,
        "former": [asdict(one) for one in entry.former],
        "how_to_test": entry.claim.how_to_test,
        "values": dict(outcome.values) if outcome else {},
        "second_values": dict(outcome.second) if outcome else {},
        "x_label": entry.claim.x_label,
        "y_label": entry.claim.y_label,
        "lines": {name: asdict(line) for name, line in outcome.lines.items()} if outcome else {},
    }


def _is_wanted(entry: Entry, query: ClaimsQuery) -> bool:
    if query.verdict and (entry.verdict or "not measured") not in query.verdict:
        return False
    said = entry.claim
    text = f"{said.id} {said.section} {said.study} {said.statement}".casefold()
    return query.q is None or all(word in text for word in query.q.casefold().split())
