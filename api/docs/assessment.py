"""What the docs say of sweeps and assessment: definitions, outcomes and pictures."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from api.docs.markdown import table as _table
from benchmark.assessment import assess as assessment
from benchmark.assessment.definitions import DEFINITIONS
from benchmark.results.csv_tables import Row
from benchmark.results.store import PUBLISHED
from benchmark.results.times import read_times
from benchmark.sweeps import sweep_tables
from benchmark.sweeps.plan import SERIES
from benchmark.sweeps.record import swept

_MARKS = {"agrees": "=", "near": "~", "opposed": "x", "not judged": " ·", "not measured": " –"}


def definitions() -> str:
    """List every property with its experiment and limits."""
    rows = [
        (str(number), d.name, d.measure, d.limits() or "not judged", d.why)
        for number, d in enumerate(DEFINITIONS.values(), start=1)
    ]
    header = ("", "property", "measured as (or why not)", "score", "why it is not judged elsewhere")
    return _table(header, rows)


def outcomes() -> str:
    """Put survey and measurement side by side, a row a method."""
    document = _document()
    rows = [
        (
            method["method"],
            *(_cell(v["survey"], v["agreement"], v["measured"]) for v in method["properties"]),
            *(str(method["counts"][name]) for name in assessment.VERDICTS),
        )
        for method in document["methods"]
    ]
    totals = "; ".join(f"{name} {count}" for name, count in document["totals"].items())
    return f"{totals}.\n\n" + _table(("method", *_numbers(), *assessment.VERDICTS), rows)


def features() -> str:
    """List the reference series."""
    rows = [
        (
            f"`{series.name}`",
            series.description,
            ", ".join(dict.fromkeys(setting.sweep for setting in series.settings())),
        )
        for series in SERIES.values()
    ]
    return _table(("series", "feature", "sweeps"), rows)


def accuracy() -> str:
    """Write the tables of the reference settings."""
    return _sweep_tables(lambda table: table.title.partition(":")[0] == "reference")


def faults() -> str:
    """Write the tables of other shapes, stray light, other lights and broken pixels."""
    return _sweep_tables(
        lambda table: table.series == "frames" and table.title.partition(":")[0] != "radius"
    )


def _sweep_tables(wanted: Callable[[sweep_tables.SweepTable], bool]) -> str:
    shown = [table for table in sweep_tables.tables(_rows()) if wanted(table)]
    if not shown:
        return "Nothing is published yet."
    return "\n\n".join(
        f"### {table.series}, {table.title}\n\n"
        + _table(
            (table.first, *table.columns),
            [(name, *(text for _, _, text in cells)) for name, cells in table.rows],
        )
        for table in shown
    )


def features_without_measure() -> str:
    """List what no reference feature fits, with the reason."""
    rows = [
        (f"`{n}`", s or "any", reason) for s, n, reason in sweep_tables.unmeasured_settings(_rows())
    ]
    return _table(("extractor", "series", "reason"), rows) if rows else "Nothing is left out."


@cache
def _rows() -> list[Row]:
    return swept()


@cache
def _document() -> dict[str, Any]:
    return assessment.document(assessment.assess(times=read_times(PUBLISHED).rows))


def _numbers() -> list[str]:
    return [str(number) for number in range(1, len(DEFINITIONS) + 1)]


def _cell(survey: int, agreement: str, measured: int | None) -> str:
    return f"{survey}{_MARKS[agreement]}{'' if measured is None else measured}"
