"""Refusals as RFC 9457 problem documents."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:problem-type:sun-sensor-atlas:"
LONGEST_ECHO = 200  # characters of the caller's own input that a problem repeats


@dataclass(frozen=True)
class Violation:
    """One thing wrong with a request.

    Attributes
    ----------
    parameter : the name of the parameter, body field, header or path part
    value : what came, shortened; None where nothing came
    expected : what would have been accepted, in words
    nearest : the nearest valid name or value, if any is alike
    """

    parameter: str
    value: str | None
    expected: str
    nearest: str | None = None

    def document(self) -> dict[str, str | None]:
        """As a member of the problem's `errors`."""
        value = self.value
        if value is not None and len(value) > LONGEST_ECHO:
            value = value[:LONGEST_ECHO] + "…"
        return {
            "parameter": self.parameter[:LONGEST_ECHO],
            "value": value,
            "expected": self.expected,
            "nearest": self.nearest,
        }

    def sentence(self) -> str:
        """As a part of the problem's `detail`."""
        shown = self.document()
        hint = f"; the nearest is {self.nearest!r}" if self.nearest is not None else ""
        got = "nothing" if self.value is None else repr(shown["value"])
        return f"{shown['parameter']}: expected {self.expected}, got {got}{hint}"


class Problem(Exception):  # noqa: N818 - as RFC 9457 calls it
    """A request that is refused.

    Parameters
    ----------
    status : HTTP status code, 4xx
    kind : slug of the problem type; the type is `urn:problem-type:sun-sensor-atlas:<kind>`
    detail : what is wrong with this request; made from `errors` where left out
    errors : the violations found, every one of them
    headers : response headers, such as `Allow`
    """

    def __init__(
        self,
        status: int,
        kind: str,
        detail: str | None = None,
        errors: Sequence[Violation] = (),
        headers: Mapping[str, str] | None = None,
    ) -> None:
        self.kind = kind
        self.errors = tuple(errors)
        self.status_code = status
        self.detail = detail or "; ".join(error.sentence() for error in self.errors)
        self.headers = headers
        Exception.__init__(self, self.detail)  # whatever else it is (`api.web.requests`)

    def document(self, instance: str) -> dict[str, Any]:
        """Return the members of the problem document; `instance` is the path asked for."""
        return {
            "type": TYPE_PREFIX + self.kind,
            "title": self.kind.replace("-", " ").capitalize(),
            "status": self.status_code,
            "detail": self.detail,
            "instance": instance,
            "errors": [error.document() for error in self.errors],
        }
