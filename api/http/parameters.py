"""Parameters of an endpoint, declared once: read from a query or a body, and documented.

What is not declared is refused, with the nearest declared name; a value that is not valid is
refused, with the nearest valid one. A `Parameters` reads both encodings and writes both
OpenAPI descriptions, so that the document cannot say other than what is checked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl, urlencode

from api.http.nearest import nearest
from api.http.problems import Problem, Violation
from api.http.values import InvalidValueError, Kind

MOST_FIELDS = 500  # of one query
MOST_VALUES = 100  # of one parameter


@dataclass(frozen=True)
class Parameter:
    """A named parameter.

    Attributes
    ----------
    name : as in the query and in a body
    kind : what a value may be
    description : for the documentation
    repeatable : whether it may be given several times (a list in a body); its value is then a
        sorted tuple without duplicates, empty where it is not given
    default : the value of one that is not repeatable, where it is not given
    """

    name: str
    kind: Kind
    description: str
    repeatable: bool = False
    default: Any = None

    def absent(self) -> Any:
        """Return the value where the parameter is not given."""
        return () if self.repeatable else self.default

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of the parameter."""
        schema = self.kind.schema()
        if self.repeatable:
            return {"type": "array", "items": schema, "maxItems": MOST_VALUES}
        if self.default is not None:
            schema["default"] = self.default
        return schema


Arguments = dict[str, Any]


class Parameters:
    """The parameters of one endpoint.

    Parameters
    ----------
    declared : the parameters, in the order of the documentation
    """

    def __init__(self, declared: Iterable[Parameter] = ()) -> None:
        self.declared = tuple(declared)
        self._by_name = {parameter.name: parameter for parameter in self.declared}
        self._absent = {parameter.name: parameter.absent() for parameter in self.declared}

    def from_query(self, query: bytes) -> Arguments:
        """Read a query string: a value for every declared parameter.

        Raises
        ------
        Problem
            400 for names that are not declared and for a query that cannot be read; 422 for
            values that are not valid, each with its nearest.
        """
        if not query:
            return dict(self._absent)
        try:
            pairs = parse_qsl(
                query.decode("ascii"),
                keep_blank_values=True,
                strict_parsing=True,
                errors="strict",
                max_num_fields=MOST_FIELDS,
            )
        except ValueError as error:
            expected = f"at most {MOST_FIELDS} fields name=value joined by &, percent-encoded UTF-8"
            violation = Violation("query", query.decode("latin-1"), expected)
            raise Problem(400, "malformed-query", errors=[violation]) from error
        given: dict[str, list[str]] = {}
        for name, text in pairs:
            given.setdefault(name, []).append(text)
        self._refuse_unknown(given)
        violations: list[Violation] = []
        arguments = dict(self._absent)
        for name, texts in given.items():
            parameter = self._by_name[name]
            if len(texts) > 1 and not parameter.repeatable:
                violations.append(Violation(name, ", ".join(texts), "one value, given once"))
                continue
            if len(texts) > MOST_VALUES:
                violations.append(_too_many(name, len(texts)))
                continue
            values = _values(name, parameter.kind, parameter.kind.from_text, texts, violations)
            if values:
                arguments[name] = _settled(parameter, values)
        if violations:
            raise Problem(422, "invalid-value", errors=violations)
        return arguments

    def from_body(self, body: object) -> Arguments:
        """Read a parsed JSON body: an object whose members are the parameters.

        Raises
        ------
        Problem
            As `from_query`; a body that is no object is a 422.
        """
        if not isinstance(body, dict):
            violation = Violation("body", _shown(body), "a JSON object")
            raise Problem(422, "invalid-value", errors=[violation])
        self._refuse_unknown(body)
        violations: list[Violation] = []
        arguments = dict(self._absent)
        for name, given in body.items():
            parameter = self._by_name[name]
            if parameter.repeatable and not isinstance(given, list):
                expected = f"a list, each item {parameter.kind.expected()}"
                violations.append(Violation(name, _shown(given), expected))
                continue
            if parameter.repeatable and len(given) > MOST_VALUES:
                violations.append(_too_many(name, len(given)))
                continue
            items = given if parameter.repeatable else [given]
            values = _values(name, parameter.kind, parameter.kind.from_json, items, violations)
            if values:
                arguments[name] = _settled(parameter, values)
        if violations:
            raise Problem(422, "invalid-value", errors=violations)
        return arguments

    def canonical(self, arguments: Arguments) -> str:
        """Return the one query string that means `arguments`; defaults are left out."""
        pairs: list[tuple[str, str]] = []
        for parameter in self.declared:
            value = arguments[parameter.name]
            if value == parameter.absent():
                continue
            items = value if parameter.repeatable else (value,)
            pairs.extend((parameter.name, _text(item)) for item in items)
        return urlencode(pairs)

    def _refuse_unknown(self, names: Iterable[str]) -> None:
        unknown = [name for name in names if name not in self._by_name]
        if unknown:
            declared = sorted(self._by_name)
            expected = f"one of {', '.join(declared)}" if declared else "no parameters"
            raise Problem(
                400,
                "unknown-parameter",
                errors=[
                    Violation(name, None, f"a parameter name, {expected}", nearest(name, declared))
                    for name in unknown
                ],
            )

    def openapi(self) -> list[dict[str, Any]]:
        """Return the OpenAPI parameter objects of the query."""
        return [
            {
                "name": parameter.name,
                "in": "query",
                "required": False,
                "description": parameter.description,
                "schema": parameter.schema(),
                **({"style": "form", "explode": True} if parameter.repeatable else {}),
            }
            for parameter in self.declared
        ]

    def body_schema(self) -> dict[str, Any]:
        """Return the JSON Schema of the body."""
        return {
            "type": "object",
            "additionalProperties": False,
            "properties": {
                parameter.name: {**parameter.schema(), "description": parameter.description}
                for parameter in self.declared
            },
        }


def _values(
    name: str,
    kind: Kind,
    read: Callable[[Any], Any],
    given: Sequence[Any],
    violations: list[Violation],
) -> list[Any]:
    """Read every value, adding a violation for each that is not valid."""
    values = []
    for item in given:
        try:
            values.append(read(item))
        except InvalidValueError as error:
            violations.append(Violation(name, _shown(item), kind.expected(), error.nearest))
    return values


def _too_many(name: str, number: int) -> Violation:
    return Violation(name, f"{number} values", f"at most {MOST_VALUES} values")


def _settled(parameter: Parameter, values: list[Any]) -> Any:
    return tuple(sorted(set(values))) if parameter.repeatable else values[0]


def _shown(value: object) -> str:
    """Return a value as the refusal repeats it."""
    if isinstance(value, str):
        return value
    if isinstance(value, Mapping | list):
        return f"{'an object' if isinstance(value, Mapping) else 'a list'} of {len(value)} items"
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "null"}[value]
    if isinstance(value, int) and value.bit_length() > 256:  # str() of it may raise
        return "a very long integer"
    return str(value)


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
