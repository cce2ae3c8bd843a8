"""Options that filter by the attributes of studies, as several commands take them."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from api.cli.completion import values
from registry.taxonomy import NO_IMPLEMENTATION_STATED, NONE_STATED


def _option(attribute: str) -> typer.models.OptionInfo:
    text = f"Only this {attribute}; may be repeated."
    return _values(f"--{attribute}", attribute, text)


def _exclude(attribute: str) -> typer.models.OptionInfo:
    text = f"Exclude this {attribute}; may be repeated."
    return _values(f"--exclude-{attribute}", attribute, text)


def _values(name: str, attribute: str, text: str) -> typer.models.OptionInfo:
    found: typer.models.OptionInfo = typer.Option(
        name,
        help=text,
        show_default=False,
        autocompletion=values(attribute),
        callback=_as_in_the_taxonomy,
    )
    return found


def _as_in_the_taxonomy(given: list[str] | None) -> list[str] | None:
    """Take "none stated", as tables print it, for the taxonomy's "None"."""
    if given is None:
        return None
    return [NO_IMPLEMENTATION_STATED if value == NONE_STATED else value for value in given]


class Edition(StrEnum):
    """Which studies: the survey's, or these and those added after it."""

    SURVEY = "survey"
    ALL = "all"


EditionOption = Annotated[
    Edition, typer.Option("--edition", help="Studies of the survey, or all, including added ones.")
]

Task = Annotated[list[str] | None, _option("task")]
Error = Annotated[list[str] | None, _option("error")]
Accuracy = Annotated[list[str] | None, _option("accuracy")]
Detector = Annotated[list[str] | None, _option("detector")]
Mask = Annotated[list[str] | None, _option("mask")]
Model = Annotated[list[str] | None, _option("model")]
Extractor = Annotated[list[str] | None, _option("extractor")]

NoTask = Annotated[list[str] | None, _exclude("task")]
NoError = Annotated[list[str] | None, _exclude("error")]
NoAccuracy = Annotated[list[str] | None, _exclude("accuracy")]
NoDetector = Annotated[list[str] | None, _exclude("detector")]
NoMask = Annotated[list[str] | None, _exclude("mask")]
NoModel = Annotated[list[str] | None, _exclude("model")]
NoExtractor = Annotated[list[str] | None, _exclude("extractor")]
