"""`sunatlas curves`: how many calibration poses the leaders of each data set need."""

from __future__ import annotations

from api.cli.asking import ask
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit_answer
from api.schema.curves import CurvesQuery
from api.schema.parameters import LARGEST_PAGE
from api.service.scores import curves as learning_curves

#: What a terminal shows; JSON has everything.
_SHOWN = (
    *("dataset", "pipeline", "needed", "range", "error_from", "answers_from", "of"),
    *("floor_deg", "over_bound"),
)


@asked_by(CurvesQuery, "dataset", "extractor", "model")
def curves(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Show how many calibration poses pipelines need.

    needed: number of poses with which half of the random draws are within 10 % of the error floor
    and have 95 % availability; range: first and last draw; error from, answers from: each criterion
    alone; of: poses in the data set. A dash means more poses than the data set has. Values are from
    the published results (docs/learning-curves.md).
    """
    answer = ask(learning_curves, {**asked, "limit": LARGEST_PAGE})
    shown = [
        {
            "dataset": row["dataset"],
            "pipeline": f"{row['extractor']} + {row['model']}",
            "needed": _poses(row["needed_poses"]),
            "range": f"{_poses(row['needed_low'])} to {_poses(row['needed_high'])}",
            "error_from": _poses(row["error_poses"]),
            "answers_from": _poses(row["answers_poses"]),
            "of": row["poses"],
            "floor_deg": row["floor_error_deg"],
            "over_bound": row["over_bound"],
        }
        for row in answer.document["items"]
    ]
    emit_answer(answer, form, _SHOWN, rows=shown)


def _poses(number: int | None) -> str:
    return "-" if number is None else str(number)
