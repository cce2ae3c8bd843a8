"""The table of a recommendation, put together from pieces as its document is.

It is what `api.columns.csv_of` makes of the rows of the document (`api.recommending.rows`): the
tests hold the two against each other.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from typing import Any

from api.cells import LIST_SEPARATOR, cell
from api.columns import RECOMMENDATIONS, flat
from api.http.recommended import KeptPieces
from files.csv_writing import csv_text
from registry.designs import DesignTable, Kept
from registry.paths import path_table
from registry.ranking import support
from registry.recommendation import Answered

MEASURED = tuple(name for name in RECOMMENDATIONS if name.startswith("measured_"))
_NOT_MEASURED = "," * (len(MEASURED) - 1)

_PIECES: weakref.WeakKeyDictionary[DesignTable, KeptPieces[bytes]] = weakref.WeakKeyDictionary()


def table_text(found: Answered, limit: int | None = None, calibrations: int | None = None) -> str:
    """Return an answer as CSV: a row a calibration.

    Parameters
    ----------
    found : the answer
    limit, calibrations : the most architectures, and calibrations of each; None for all
    """
    question, keys = found.question, path_table(found.question.table.facts).studies
    lines = [_line(RECOMMENDATIONS)]
    for at, place in enumerate(found.ranked.places[:limit]):
        detector, mask = place.place.architecture
        about = (at + 1, detector, mask, bool(place.advice))
        first = _line((*about, _list(keys(place.studies)), at in found.pareto))
        for number, design_at in enumerate(place.designs[:calibrations].tolist(), 1):
            kept = question.kept(design_at)
            design = kept.design
            stages = (design.extractor, _list(design.stages[:-1]), design.model)
            studies = _list(keys(place.taken(kept)))
            then = _line((number, *stages, studies, round(support(kept, place), 4)))
            lines.append(f"{first},{then},{_measured(kept, place.number, found)}")
    return "\n".join(lines) + "\n"


def _measured(kept: Kept, place: int, found: Answered) -> str:
    """Return the cells of what is measured of a calibration; all empty where nothing is."""
    if kept.row is None:
        return _NOT_MEASURED
    question = found.question
    pieces = _PIECES.setdefault(question.table, KeptPieces())
    key = question.told_by(kept, place)
    piece = pieces.get(key)
    if piece is None:
        told: Mapping[str, Any] = kept.row.to_dict(question.asked, question.partly(place))
        piece = pieces.keep(key, _line(tuple(flat({"measured": told}, MEASURED).values())).encode())
    return piece.decode()


def _line(values: Sequence[Any]) -> str:
    """Return cells of a record, without its end."""
    return csv_text([cell(value) for value in values], ())[:-1]


def _list(words: Sequence[str]) -> str:
    return LIST_SEPARATOR.join(words)
