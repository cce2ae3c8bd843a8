"""Options of commands that are parameters of the HTTP API: declared once, by the query's model."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterator, Sequence
from enum import StrEnum
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeAlias, Union, get_args, get_origin

import typer
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from api.schema import words
from api.schema.former_names import PARAMETERS
from api.schema.parameters import OneOf
from registry.taxonomy import ATTRIBUTES, NO_IMPLEMENTATION_STATED, NONE_STATED

Asked: TypeAlias = dict[str, Any]
"""What is asked, by parameter of the HTTP API; without what no option asks for."""

_MANY = frozenset(
    get_args(kind)[1]
    for kind in (
        *(words.DatasetName, words.Condition, words.ExtractorName, words.ModelName),
        *(words.MethodName, words.Property),
        *(getattr(words, name.title()) for name in ATTRIBUTES),
    )
)
"""Lists that the help does not print."""

_PLAIN = (str, int, float, bool)


def asked_by(
    model: type[BaseModel], *names: str, **renamed: str
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the parameters of a query as options, in place of its argument `asked`.

    Options are called as their parameters are, but for those of `renamed`.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True).parameters
        options = {renamed.get(name, name): name for name in names}
        added = [
            inspect.Parameter(
                option,
                inspect.Parameter.KEYWORD_ONLY,
                default=_default(model.model_fields[name]),
                annotation=option_of(model, name, option),
            )
            for option, name in options.items()
        ]

        def call(**given: Any) -> None:
            found = {name: given.pop(option) for option, name in options.items()}
            command(asked=dict(_given(found)), **given)

        parameters: list[inspect.Parameter] = []
        for parameter in own.values():
            parameters += added if parameter.name == "asked" else [parameter]
        call.__name__, call.__doc__ = command.__name__, command.__doc__
        call.__annotations__ = {one.name: one.annotation for one in parameters}
        call.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        return call

    return decorate


def option_of(model: type[BaseModel], name: str, option: str | None = None) -> Any:
    """Return the annotated type of an option that is a parameter of a query."""
    field = model.model_fields[name]
    default = _default(field)
    kinds = list(_kinds(field.annotation))
    word = next((one for one in (*kinds, *field.metadata) if isinstance(one, OneOf)), None)
    several = any(get_origin(one) is list for one in kinds)
    kind: Any = next(one for one in kinds if one in _PLAIN or get_origin(one) is Literal)
    said = (field.description or "").removesuffix(".")
    if word and word not in _MANY:
        said += f": {', '.join(word.words())}"
    settings: dict[str, Any] = {
        "help": f"{said}; may be repeated." if several else f"{said}.",
        "show_default": default is not None,
    }
    if word:
        settings["autocompletion"] = complete(word)
    if isinstance(default, int):  # of what has no default the answer says what it can be
        for one in field.metadata:
            settings |= {
                most: getattr(one, at)
                for at, most in (("ge", "min"), ("le", "max"))
                if hasattr(one, at)
            }
    if several and get_origin(kind) is Literal:  # Typer takes no list of literals
        kind = _choices(get_args(kind))
    made = list[kind] if several else kind
    flag = f"--{(option or name).replace('_', '-')}"
    flags = [flag, *(f"--{old}" for old, new in PARAMETERS.items() if new == name)]
    return Annotated[made | None if default is None else made, typer.Option(*flags, **settings)]


def _kinds(annotation: Any) -> Iterator[Any]:
    """Yield a type, what it is made of, and what annotates it."""
    yield annotation
    if get_origin(annotation) in (Annotated, Union, UnionType, list):
        for one in get_args(annotation):
            if one is not NoneType:
                yield from _kinds(one)


def _choices(choices: Sequence[str]) -> type[StrEnum]:
    make: Any = StrEnum  # mypy takes members in the source alone
    made: type[StrEnum] = make("Choice", {choice: choice for choice in choices})
    return made


def _default(field: FieldInfo) -> Any:
    return None if field.default is PydanticUndefined else field.default


def _given(asked: Asked) -> Iterator[tuple[str, Any]]:
    """Yield what is asked; "none stated", as tables print it, is the taxonomy's "None"."""
    for name, value in asked.items():
        if isinstance(value, list) and value:
            plain = [str(one) for one in value]
            yield name, [NO_IMPLEMENTATION_STATED if one == NONE_STATED else one for one in plain]
        elif value is not None and value != []:
            yield name, value


VARIABLE = "_SUNATLAS_COMPLETE"  # that a shell sets when it asks


def complete(kind: Any) -> Callable[[str], list[str]]:
    """Return what completes a word of a closed list, or of a type of one, as Typer takes it."""
    word: OneOf = kind if isinstance(kind, OneOf) else get_args(kind)[1]

    def completed(incomplete: str) -> list[str]:
        return _quoted([one for one in word.words() if one.startswith(incomplete)])

    return completed


def _quoted(words: Sequence[str]) -> list[str]:
    """Return words as they are typed: bash takes what is completed as it is."""
    if os.environ.get(VARIABLE) != "complete_bash":
        return list(words)
    return [word.replace(" ", "\\ ") for word in words]
