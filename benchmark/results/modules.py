"""Digests of the modules of ours that code imports, found by following import statements.

Wherever they stand, but under ``if TYPE_CHECKING``; the packages that a module lies in count, too.
Modules found at run time (`importlib.import_module`, `pkgutil`) are not followed. Comments,
docstrings and formatting do not enter a digest.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

FIRST_PARTY = (
    *("files", "survey_data", "algorithms", "registry"),
    *("calibrate", "benchmark", "api"),
)
#: What makes each stage of the data, extractors and models that it is handed, in order.
STAGES: Mapping[str, str] = {
    "data": "benchmark.running.condition_data",
    "features": "benchmark.running.readings",
    "predictions": "benchmark.running.fitting",
    "scores": "benchmark.running.judging",
}
#: Not followed, but for the stages: facts, and what plans, hands out, keeps or shows numbers.
_MACHINERY = tuple(
    f"{name}."
    for name in (
        *("files", "survey_data", "registry", "calibrate", "api"),
        *("benchmark.plan", "benchmark.results", "benchmark.running"),
    )
)
#: Fields of syntax nodes that say how a thing was written, or that only some Python versions have.
_NOT_CODE = frozenset({"ctx", "kind", "type_comment", "type_ignores"})
_DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


class ModuleError(ValueError):
    """A module has no source file, or one that cannot be parsed."""


class Module(NamedTuple):
    """A digest of a module's code, and the dotted names that it imports."""

    digest: str
    imports: tuple[str, ...]


def modules_digest(*entries: str) -> str:
    """Digest (32 hexadecimal digits) of all that `reached` finds."""
    lines = [f"{name} {digest}" for name, digest in reached(*entries).items()]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:32]


def reached(*entries: str) -> dict[str, str]:
    """Return the digests of modules and of all of ours that they import, by name, sorted.

    Their top-level packages are ours, too: a plug-in kept elsewhere counts. ModuleError where one
    has no source file, or it cannot be parsed.
    """
    ours = {*FIRST_PARTY, *(entry.partition(".")[0] for entry in entries)}
    found: dict[str, str] = {}
    waiting = list(entries)
    while waiting:
        name = waiting.pop()
        path = module_path(name)
        if path is None:
            raise ModuleError(f"no source file found for module {name!r}")
        module = _module(name, path, path.stat().st_mtime_ns)
        found[name] = module.digest
        for target in (name.rpartition(".")[0], *module.imports):
            other = _module_of(target, ours)
            passed_over = f"{other}.".startswith(_MACHINERY) and other not in STAGES.values()
            if other and other not in found and not passed_over:
                waiting.append(other)
    return dict(sorted(found.items()))


def _module_of(target: str, ours: set[str]) -> str:
    """Return the longest beginning of a dotted name that is a module of ours; empty for none."""
    while target and target.partition(".")[0] in ours and module_path(target) is None:
        target = target.rpartition(".")[0]
    return target if target.partition(".")[0] in ours else ""


@cache
def module_path(name: str) -> Path | None:
    """Source file of a module, found without importing it; None where there is none."""
    top, *rest = name.split(".")
    spec = importlib.util.find_spec(top)
    if spec is None:
        return None
    if spec.submodule_search_locations is None:
        return Path(spec.origin) if spec.origin and not rest else None
    bases = [Path(root).joinpath(*rest) for root in spec.submodule_search_locations]
    found = (path for base in bases for path in (base / "__init__.py", base.with_suffix(".py")))
    return next(filter(Path.is_file, found), None)


@cache
def _module(name: str, path: Path, _changed: int) -> Module:
    try:
        tree = ast.parse(path.read_bytes(), filename=str(path))
    except (SyntaxError, ValueError) as error:
        raise ModuleError(f"{path} cannot be parsed: {error}") from error
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    digest = hashlib.sha256("".join(_spell(tree)).encode()).hexdigest()[:32]
    return Module(digest, tuple(dict.fromkeys(_imports(tree, package))))


def _imports(node: ast.AST, package: list[str]) -> Iterator[str]:
    """Yield the dotted names that a tree imports; what is taken of a module as if it were one."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from (alias.name for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            above = package[: len(package) + 1 - child.level] if child.level else []
            base = [*above, child.module] if child.module else above
            yield from (".".join([*base, alias.name]) for alias in child.names)
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            yield from (name for one in child.orelse for name in _imports(one, package))
        elif not isinstance(child, ast.expr):
            yield from _imports(child, package)


def _spell(node: object) -> Iterator[str]:
    """Spell a syntax tree, the same under every Python version and without docstrings."""
    if isinstance(node, ast.AST):
        yield f"({type(node).__name__}"
        for field in node._fields:
            value = getattr(node, field, None)
            if field == "body" and isinstance(node, _DOCUMENTED) and ast.get_docstring(node, False):
                value = node.body[1:]
            if value is not None and value != [] and field not in _NOT_CODE:
                yield f" {field}="
                yield from _spell(value)
        yield ")"
    elif isinstance(node, list):
        for item in node:
            yield from _spell(item)
            yield ","
    else:
        yield f"{type(node).__name__}:{node!r}"
