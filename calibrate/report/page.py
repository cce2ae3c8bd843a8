"""Reports of a calibration and of a correction: each one HTML file that needs nothing else."""

from __future__ import annotations

import datetime as dt
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from calibrate.calibration import Calibration
from calibrate.documents import selection_table, versions
from calibrate.places import off_axis_deg
from calibrate.readings import Readings
from calibrate.recalibration import Correction
from calibrate.report.errors import (
    THREE_SIGMA,
    Errors,
    by_axis,
    by_band,
    by_run,
    by_temperature,
    fewest_for,
    field_of,
)
from calibrate.report.factory import Compared
from calibrate.report.pictures import pictures
from calibrate.report.requirement import Judged, Requirement, judged
from calibrate.settings import UNSTATED

_TEMPLATES = Path(__file__).parent
#: Coverage factor of the expanded uncertainties of a certificate.
COVERAGE_FACTOR = 2.0
#: Rows left out, or poses of a correction, that are listed one by one; the JSON has all.
_LISTED, _LISTED_RUNS = 60, 30
#: Letters of a reason or a refusal that are shown.
_LONGEST = 160


@dataclass(frozen=True)
class Asked:
    """What is wanted of a report beside the calibration itself."""

    requirements: tuple[Requirement, ...] = ()  # on its errors
    compared: Compared | None = None  # with a factory's calibration
    certificate: str = ""  # its name among the files; empty for none


def outcomes(found: Calibration, asked: Asked) -> list[Judged]:
    """Return for each requirement whether it is met."""
    errors = Errors.of(found) if asked.requirements else None
    return [
        judged(one, found.readings.sun, errors) for one in asked.requirements if errors is not None
    ]


def report(
    found: Calibration,
    command: str = "",
    code: str = "",
    asked: Asked | None = None,
    today: dt.date | None = None,
) -> str:
    """Return the report as HTML text: the verdict first.

    `command` was called; `code` says what the flight code does and adds, empty where there is none;
    the report's date is by default today in UTC.
    """
    wanted = asked or Asked()
    errors = Errors.of(found)
    drawn = pictures(found, errors, wanted.requirements)
    counted = Counter(one.reason for one in found.excluded)
    return (
        templates()
        .get_template("report.html")
        .render(
            found=found,
            verdict=found.verdict,
            outcomes=[judged(one, found.readings.sun, errors) for one in wanted.requirements],
            compared=wanted.compared,
            axes=by_axis(errors),
            bands=by_band(errors),
            runs=by_run(errors)[:_LISTED_RUNS],
            temperatures=by_temperature(errors),
            field=field_of(found.readings.sun),
            fewest=fewest_for(THREE_SIGMA),
            tested=int(errors.known.sum()),
            rows=selection_table(found),
            refused=_refused(found),
            pictures={title: Markup(svg) for title, svg in drawn.items()},  # noqa: S704 - drawn here
            excluded=counted.most_common(),
            listed=found.excluded[:_LISTED],
            settings=_settings(found),
            files=_files(found),
            versions=versions(),
            code=code,
            command=command,
            today=(today or dt.datetime.now(dt.UTC).date()).isoformat(),
            coverage_factor=COVERAGE_FACTOR,
            unstated=UNSTATED,
        )
    )


def templates() -> Environment:
    """Return what makes reports of their templates."""
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(deg=_deg, percent=_percent, short=_short)
    return environment


def _refused(found: Calibration) -> dict[str, list[str]]:
    """Return the models that cannot be fitted, by reason; what came is left out of it."""
    reasons: dict[str, list[str]] = {}
    for one in found.candidates:
        if one.refused:
            said = one.refused.split("; got ")[0].removeprefix(f"{one.name} ")
            reasons.setdefault(said, []).append(one.name)
    return reasons


def _settings(found: Calibration) -> list[tuple[str, Any]]:
    """Return settings by name, those that nobody stated left out."""
    held = found.settings.model_dump(mode="json", exclude_none=True, exclude={"certificate"})
    rows = []
    for section, values in held.items():
        if not isinstance(values, dict):
            rows.append((section, _value(values)))
            continue
        rows += [(f"{section}.{name}", _value(value)) for name, value in values.items()]
    return rows


def _value(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(_value(one) for one in value) or "none"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _files(found: Calibration) -> list[tuple[str, str]]:
    digests = found.digests or ("",) * len(found.sources)
    return list(zip(found.sources, digests, strict=False))


def _deg(value: float | None) -> str:
    return "-" if value is None or value != value else f"{value:.3g}"  # noqa: PLR0124 - NaN


def _percent(value: float | None) -> str:
    return "-" if value is None or value != value else f"{100 * value:.1f}"  # noqa: PLR0124 - NaN


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1].rstrip() + "\u2026"


def correction_report(
    found: Correction,
    poses: Readings,
    outcomes: Sequence[Judged],
    said: Mapping[str, str],
    today: dt.date | None = None,
) -> str:
    """Return the report of a correction, by its poses, as HTML text.

    `said` is what else is said, by its name; the date is by default today in UTC.
    """
    off = off_axis_deg(poses.sun)
    order = np.argsort(-np.nan_to_num(found.errors_deg, nan=np.inf), kind="stable")
    rows = [
        (int(poses.rows[at]), float(off[at]), float(found.errors_deg[at])) for at in order[:_LISTED]
    ]
    return (
        templates()
        .get_template("correction.html")
        .render(
            found=found,
            poses=len(poses),
            outcomes=outcomes,
            rows=rows,
            reach=float(off.max()),
            said=said,
            today=(today or dt.datetime.now(dt.UTC).date()).isoformat(),
        )
    )


def outcomes_of(
    found: Correction, poses: Readings, requirements: Sequence[Requirement]
) -> list[Judged]:
    """Return whether each requirement is met by the poses, each corrected while left out.

    A pose without an answer counts as an error above the limit.
    """
    answered = np.isfinite(found.errors_deg)
    errors = Errors(
        poses,
        np.full((len(poses), 3), np.nan),
        found.errors_deg,
        np.where(answered, 0.0, np.nan)[:, None] * np.ones(2),
    )
    return [judged(one, poses.sun, errors) for one in requirements]
