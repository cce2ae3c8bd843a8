"""The fields of a form that asks for a calibration, beside its files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Question
from api.schema.parameters import GIVEN


class CalibrationFields(Question):
    """How files are to be calibrated, and which product is the answer."""

    config: str = Field(
        "",
        description="TOML, as `sunatlas calibrate --init` writes it; guessed from the header by "
        "default.",
    )
    model: str = Field("", description="The only model tried; all by default.")
    apply: Literal["true", "false"] = Field(
        "false", description="Whether conventions found with certainty are applied."
    )
    require: str = Field("", description="Largest error allowed, such as `0.1deg@3sigma,60deg`.")
    answer: Annotated[Literal["json", "report", "zip"] | None, GIVEN] = Field(
        None, description="Before `Accept`: calibration, report, or all files."
    )
