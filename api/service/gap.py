"""The gap: what is reported of every architecture, and what simulation and physics allow."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from api.addresses import architecture_page
from api.figures.figure import Figure
from api.figures.gap import gap_figure, smallest_report
from api.schema.measured_figures import Gap, GapQuery
from api.schema.requirements import RequirementsQuery
from api.service import recommendations
from api.service.documents import Document
from api.service.figures import measured_document
from api.service.knowledge import Knowledge
from registry.answer import RankedArchitecture
from registry.reports import Report


def gap(known: Knowledge, query: GapQuery) -> Document:
    """Return reported accuracy, error in flight, own error and bound of every architecture.

    Measured numbers are those of the pipeline with the smallest error in flight (of the smallest
    own error with `level=own`), as in the answer. CSV: a row per architecture, reports as lists.
    """
    return measured_document(gap_drawn(known, query), Gap)


def gap_drawn(known: Knowledge, query: GapQuery) -> Figure:
    """Return the gap, rows in the order of a level; what has no such number comes last."""
    asked = RequirementsQuery(
        **{name: getattr(query, name) for name in ("detector", "mask", "task", "error")},
        level="own" if query.level == "own" else "flight",
        edition=query.edition,
    )
    facts = known.of(query.edition).facts
    found = recommendations.ask(asked, known.measured_pipelines, facts)
    rows = [_row(one, recommendations.architecture(found, one).best) for one in found.architectures]
    order = [(_at_level(row, query.level), at) for at, row in enumerate(rows)]
    order.sort(key=lambda pair: (pair[0] is None, pair[0] or 0.0, pair[1]))
    return gap_figure([rows[at] for _, at in order], query.level)


def _at_level(row: dict[str, Any], level: str) -> float | None:
    if level == "reported":
        return smallest_report(row)
    found: float | None = row["bound_deg" if level == "bound" else f"{level}_error_deg"]
    return found


def _row(one: RankedArchitecture, best: Any) -> dict[str, Any]:
    detector, mask = one.place.architecture
    measured = {} if best is None or best.measured is None else best.measured.model_dump()
    reports = one.reports if not one.question.requirements.names or "reported" in one.meets else ()
    studies, of_studies = _reported(reports, "study")
    products, of_products = _reported(reports, "product")
    return {
        "detector": detector,
        "mask": mask,
        **{name: measured.get(name) for name in _MEASURED},
        "studies": studies,
        "study_rms_deg": of_studies,
        "products": products,
        "product_rms_deg": of_products,
        "page": architecture_page(detector, mask),
    }


def _reported(reports: Iterable[Report], kind: str) -> tuple[list[str], list[float]]:
    """Return who reports an accuracy and the accuracies as RMS, the smallest first."""
    found: Sequence[tuple[float, str]] = sorted(
        (report.rms_deg, report.key if kind == "study" else report.name)
        for report in reports
        if report.kind == kind and report.rms_deg is not None
    )
    return [name for _, name in found], [float(f"{rms:.4g}") for rms, _ in found]


_MEASURED = (
    *("flight_error_deg", "flight_low_deg", "flight_high_deg"),
    *("own_error_deg", "own_low_deg", "own_high_deg"),
    *("bound_deg", "dataset", "extractor", "model"),
)
