"""The page of the Python interface: public names of the modules that a user imports."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import Any

from api.docs.markdown import table
from survey_data import labels

#: By what one wants; each module's public names are listed, in their order in the file.
MODULES: dict[str, tuple[str, ...]] = {
    "Data sets": (
        "benchmark.datasets",
        "benchmark.datasets.preset",
        "benchmark.datasets.samples",
        "benchmark.datasets.export",
    ),
    "Extracting, fitting, predicting": (
        "algorithms.pipeline",
        "algorithms.contract",
        "algorithms.design",
        "algorithms.angles",
        "algorithms.calibration.saving",
        "algorithms.calibration.quality",
        "registry.catalogue",
    ),
    "Scoring": ("benchmark.metrics.score", "benchmark.metrics.bounds", "benchmark.results.store"),
    "Asking": (
        "registry.studies",
        "registry.taxonomy",
        "registry.requirements",
        "registry.recommendation",
        "registry.resolution",
        "registry.fidelity.grading",
        "registry.fidelity.purposes",
        "registry.flows",
        "benchmark.claims.ledger",
        "survey_data",
    ),
}

_SECTION = re.compile(r"^(?P<name>[A-Z][A-Za-z ]+)\n-{3,}\n", re.MULTILINE)
_SHOWN = ("Parameters", "Attributes", "Returns", "Yields", "Raises")
_LONGEST_SIGNATURE = 88

#: A function among the defaults, with the place in memory that it has in this process.
_ADDRESS = re.compile(r"<function (\w+) at 0x[0-9a-f]+>")


def interface() -> str:
    """Describe every public class and function of `MODULES`."""
    parts, seen = [], set[int]()
    for title, names in MODULES.items():
        parts.append(f"## {title}")
        for name in names:
            module = importlib.import_module(name)
            new = [one for one in _public(module) if id(one) not in seen]
            seen |= {id(one) for one in new}
            if new:
                parts += [f"### {name}", _plain(inspect.getdoc(module) or "")]
                parts += [_described(name, one) for one in new]
    return "\n\n".join(parts)


def _public(module: ModuleType) -> Iterator[Any]:
    """Give the public classes and functions of a module, of a package what it says it has.

    What a package loads with its first use is loaded: else the page would tell of what happens to
    be there already.
    """
    listed: Sequence[str] | None = getattr(module, "__all__", None)
    names = [name for name in vars(module) if not name.startswith("_")]
    found = [
        one
        for one in (getattr(module, name) for name in (names if listed is None else listed))
        if (inspect.isclass(one) or inspect.isfunction(one) or hasattr(one, "__wrapped__"))
        and (listed is not None or getattr(one, "__module__", "") == module.__name__)
        and inspect.getdoc(one)
    ]
    order = {id(one): number for number, one in enumerate(found)}
    yield from sorted(found, key=lambda one: (_line(one), order[id(one)]))


def _line(one: Any) -> tuple[str, int]:
    plain = inspect.unwrap(one)
    return plain.__module__, inspect.getsourcelines(plain)[1]


def _described(module: str, one: Any) -> str:
    head = f"#### {module}.{one.__name__}"
    return "\n\n".join(part for part in (head, _signature(one), _told(one), _methods(one)) if part)


def _signature(one: Any) -> str:
    """Write how it is called; nothing for exceptions, which callers only catch."""
    if inspect.isclass(one) and (issubclass(one, BaseException) or _is_protocol(one)):
        return ""
    try:
        said = _ADDRESS.sub(r"\1", str(inspect.signature(one))).replace("'", "")
    except ValueError:
        return ""
    said = re.sub(r"<factory>|<object object at [^>]+>", "...", said)
    said = re.sub(r"PosixPath\(([^)]*)\)", "...", said)
    text = f"{one.__name__}{said}"
    if len(text) > _LONGEST_SIGNATURE:
        text = "".join(_broken(text))
    return f"```text\n{text}\n```"


def _broken(signature: str) -> Iterator[str]:
    """Give a signature with every parameter on a line of its own."""
    depth = 0
    for place, character in enumerate(signature):
        depth += (character in "([{") - (character in ")]}")
        if character == "(" and depth == 1:
            yield "(\n    "
        elif character == "," and depth == 1:
            yield ",\n   "
        elif character == ")" and depth == 0 and not signature[place + 1 :].startswith("]"):
            yield "\n)"
        else:
            yield character


def _is_protocol(one: type) -> bool:
    return bool(getattr(one, "_is_protocol", False))


def _told(one: Any) -> str:
    """Write a docstring: its prose, then parameters, results and errors as tables."""
    text = inspect.getdoc(one) or ""
    pieces = _SECTION.split(text)
    parts = [_plain(pieces[0])]
    for name, body in zip(pieces[1::2], pieces[2::2], strict=True):
        rows = list(_entries(body)) if name in _SHOWN else []
        if rows:
            parts.append(table((name.lower(), ""), rows))
    return "\n\n".join(parts)


def _entries(body: str) -> Iterator[tuple[str, str]]:
    """Give the entries of a section, `name : type` with what stands indented below."""
    head: str = ""
    below: list[str] = []
    for line in [*body.splitlines(), "end"]:
        if line.strip() and not line.startswith(" "):
            if head:
                yield f"`{head}`", _plain(" ".join(below))
            head, below = line.strip(), []
        elif line.strip():
            below.append(line.strip())


def _methods(one: Any) -> str:
    if not inspect.isclass(one) or issubclass(one, BaseException):
        return ""
    rows = [
        (f"`{name}`", _plain((inspect.getdoc(member) or "").partition("\n\n")[0]))
        for name, member in vars(one).items()
        if not name.startswith("_")
        and (inspect.isfunction(member) or isinstance(member, classmethod | property))
        and inspect.getdoc(member)
    ]
    return table(("member", "what it does"), rows) if rows else ""


def _plain(text: str) -> str:
    """Bring a docstring to Markdown: its double backquotes to single ones, angles escaped."""
    lines = [line.strip() if not line.startswith("    ") else line for line in text.splitlines()]
    joined = "\n".join(lines).strip().replace("``", "`")
    parts = re.split(r"(`[^`]*`)", joined)
    return "".join(
        part if part.startswith("`") else re.sub(r"<(?=[a-zA-Z/])", r"\\<", labels.named(part))
        for part in parts
    )
