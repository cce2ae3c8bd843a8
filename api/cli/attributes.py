"""Options that filter by the attributes of studies, as several commands take them."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from api.cli.completion import values


def _option(attribute: str) -> typer.models.OptionInfo:
    text = f"Only with this {attribute}; may be repeated."
    found: typer.models.OptionInfo = typer.Option(
        f"--{attribute}", help=text, show_default=False, autocompletion=values(attribute)
    )
    return found


def _excluded(attribute: str) -> typer.models.OptionInfo:
    text = f"Never this {attribute}; may be repeated."
    found: typer.models.OptionInfo = typer.Option(
        f"--exclude-{attribute}", help=text, show_default=False, autocompletion=values(attribute)
    )
    return found


class Edition(StrEnum):
    """Which studies: the survey's, or these and those added after it."""

    SURVEY = "survey"
    ALL = "all"


EditionOption = Annotated[
    Edition, typer.Option("--edition", help="Studies of the survey, or all: later ones, too.")
]

Task = Annotated[list[str] | None, _option("task")]
Error = Annotated[list[str] | None, _option("error")]
Accuracy = Annotated[list[str] | None, _option("accuracy")]
Detector = Annotated[list[str] | None, _option("detector")]
Mask = Annotated[list[str] | None, _option("mask")]
Model = Annotated[list[str] | None, _option("model")]
Extractor = Annotated[list[str] | None, _option("extractor")]

NoTask = Annotated[list[str] | None, _excluded("task")]
NoError = Annotated[list[str] | None, _excluded("error")]
NoAccuracy = Annotated[list[str] | None, _excluded("accuracy")]
NoDetector = Annotated[list[str] | None, _excluded("detector")]
NoMask = Annotated[list[str] | None, _excluded("mask")]
NoModel = Annotated[list[str] | None, _excluded("model")]
NoExtractor = Annotated[list[str] | None, _excluded("extractor")]
