"""/bibliography: what is missing of each study's bibliographic data, and how to send it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any

import yaml
from fastapi import Response

from api.citations import blank_bibtex
from api.metadata.identity import identity
from api.pages.serving import PageRouter, View
from api.pages.study import IDENTITIES
from api.service.documents import Document
from api.web.answers import Answer
from api.web.dependencies import NO_PARAMETERS, Known
from api.web.negotiation import BIBTEX

router = PageRouter()

COLUMNS = ("key", "year", "title", "identity", "missing", "confirmed")
#: What a reference is made of; a url is wanted only where there is no DOI.
FIELDS = ("title", "authors", "venue", "type", "doi")
FORM = "bibliography.yml"
"""Form of the issue by which a bibliography is sent."""


class MissingMetadata(Answer):
    """The studies of which something is missing, as BibTeX with blanks to be filled in, too."""

    def representation(self, wanted: str) -> Response:
        """Return the answer in a media type."""
        if wanted != BIBTEX:
            return super().representation(wanted)
        incomplete = [row for row in self.found.document["items"] if row["missing"]]
        saved = {"Content-Disposition": 'attachment; filename="missing.bib"'}
        return self.written(blank_bibtex(incomplete), BIBTEX, **saved)


def missing_of(study: Mapping[str, Any]) -> list[str]:
    """Return what is missing of a study: fields without a value, and whether it is confirmed."""
    empty = [name for name in FIELDS if study[name] in ("", "unknown")]
    return [*empty, *([] if study["identity"] == "confirmed" else ["confirmation"])]


@router.page("/bibliography", files=(".bib",))
async def bibliography(known: Known, _asked: Annotated[None, NO_PARAMETERS] = None) -> View:
    """Every study with what is missing of it, those with most of it first."""
    rows = [_row(study.summary()) for study in known.facts.studies.values()]
    rows.sort(key=lambda row: (-len(row["missing"]), row["key"]))
    counts = {
        name: sum(name in row["missing"] for row in rows) for name in (*FIELDS, "confirmation")
    }
    complete = sum(not row["missing"] for row in rows)
    document = {"items": rows, "total": len(rows), "complete": complete, "missing": counts}
    return View(
        "studies/missing.html",
        Document(document, COLUMNS, lambda: rows),
        answer=MissingMetadata,
        identities=IDENTITIES,
        form=_form(),
    )


def _row(study: Mapping[str, Any]) -> dict[str, Any]:
    names = ("key", "title", "authors", "year", "venue", "type", "doi", "url", "identity")
    row = {name: study[name] for name in names}
    return {**row, "missing": missing_of(row), "confirmed": study["identity"] == "confirmed"}


@cache
def _form() -> str:
    """Return the address of the issue form; empty where CITATION.cff names no repository."""
    stated: Any = yaml.safe_load(identity().citation)
    repository = str(stated.get("repository-code", "")).rstrip("/")
    return f"{repository}/issues/new?template={FORM}" if repository else ""
