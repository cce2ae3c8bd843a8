"""The form that asks for a calibration, beside its files; the place of one in the queue."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Question, Shape
from api.schema.parameters import GIVEN

#: A word that no other client makes up.
TICKET = "[0-9a-f]{16,64}"


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
    ticket: str = Field(
        "",
        pattern=f"^({TICKET})?$",
        description="16 to 64 random digits 0-9a-f: `/v1/calibrations/waiting/TICKET` tells "
        "the place in the queue.",
    )


class Place(Shape):
    """The place of a calibration in the queue."""

    before: int | None = Field(
        description="Calibrations that come first, 0 while it runs; null where none of this ticket "
        "waits or runs."
    )
    wait_s: int | None = Field(description="About how long until it runs.")
