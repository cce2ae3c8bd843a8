"""The report of a correction: what changed, and the error of each pose."""

from __future__ import annotations

import datetime as dt
from collections.abc import Mapping, Sequence

import numpy as np

from algorithms.contract import Floats
from calibrate.readings import Readings
from calibrate.recalibration import Correction
from calibrate.report.errors import Errors
from calibrate.report.page import templates
from calibrate.report.requirement import Judged, Requirement, judged

#: Poses that are listed one by one.
_LISTED = 60


def correction_report(
    found: Correction,
    poses: Readings,
    outcomes: Sequence[Judged],
    said: Mapping[str, str],
    today: dt.date | None = None,
) -> str:
    """Return the report of a correction as HTML text.

    Parameters
    ----------
    found : Correction
    poses : Readings
        That it was found by.
    outcomes : sequence of Judged
        Of requirements.
    said : mapping of str to str
        What else is said, by its name.
    today : date, optional
        Of the report; by default today in UTC.
    """
    off = _off_axis_deg(poses)
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


def _off_axis_deg(poses: Readings) -> Floats:
    sun = poses.sun
    return np.asarray(np.degrees(np.arctan2(np.hypot(sun[:, 0], sun[:, 1]), sun[:, 2])))
