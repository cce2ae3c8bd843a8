"""What code a result depends on: the first-party modules reached, digested as syntax trees.

The closure is found without importing anything, by walking import statements (those inside
functions too). Comments, docstrings, formatting and line numbers do not enter the digest.
Modules found at run time only (`importlib.import_module`, `pkgutil`) are not followed.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import os
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

FIRST_PARTY = ("files", "survey_data", "algorithms", "registry", "benchmark", "api")

# Fields of syntax nodes that say how a thing was written, or that only some Python versions have.
_NOT_CODE = frozenset({"ctx", "kind", "type_comment", "type_ignores"})


Import = ast.Import | ast.ImportFrom


class ClosureError(ValueError):
    """A module whose source is needed for a digest was not found or cannot be read."""


def closure(*modules: str) -> tuple[str, ...]:
    """Names of all first-party modules that `modules` import, directly or not, sorted.

    First party are the project's packages and the top-level packages of `modules` themselves, so
    that a plug-in kept elsewhere is digested too. The packages a module merely lies in
    (``a`` and ``a.b`` of ``a.b.c``) are not followed: names taken *from* them are.

    Raises
    ------
    ClosureError
        When one of `modules` has no source file.
    """
    for name in modules:
        if module_path(name) is None:
            raise ClosureError(f"no source file found for module {name!r}")
    roots = frozenset(FIRST_PARTY) | {name.partition(".")[0] for name in modules}
    found: set[str] = set()
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        path = module_path(name)
        if name in found or path is None:
            continue
        found.add(name)
        imported = _imports(path, path.stat().st_mtime_ns, name)
        waiting.extend(other for other in imported if other.partition(".")[0] in roots)
    return tuple(sorted(found))


def closure_digest(*modules: str) -> str:
    """Digest (32 hexadecimal digits) of the code in `closure(*modules)`."""
    digest = hashlib.sha256()
    for name in closure(*modules):
        path = module_path(name)
        if path is not None:
            digest.update(f"{name} {syntax_digest(path)}\n".encode())
    return digest.hexdigest()[:32]


def syntax_digest(path: Path) -> str:
    """Digest of one file's code: equal for files that differ in comments or formatting only."""
    return _read(path, path.stat().st_mtime_ns)[0]


def module_path(name: str) -> Path | None:
    """Source file of a module, found without importing it; None where there is none."""
    top, *rest = name.split(".")
    for root in _package_directories(top):
        base = "/".join([root, *rest])
        for candidate in (f"{base}/__init__.py", f"{base}.py"):
            if os.path.isfile(candidate):  # noqa: PTH113 - asked for 20 000 times a record
                return _path(candidate)
    return None


def _package_directories(top: str) -> list[str]:
    spec = importlib.util.find_spec(top)
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        return list(spec.submodule_search_locations)
    return [spec.origin.removesuffix(".py")] if spec.origin else []


@lru_cache(maxsize=1024)
def _path(name: str) -> Path:
    return Path(name)


@lru_cache(maxsize=1024)
def _tree(path: Path, modified_ns: int) -> ast.Module:  # noqa: ARG001 - the time is the cache's key
    try:
        return ast.parse(path.read_bytes(), filename=str(path))
    except (SyntaxError, ValueError) as error:
        raise ClosureError(f"{path} cannot be parsed: {error}") from error


@lru_cache(maxsize=1024)
def _read(path: Path, modified_ns: int) -> tuple[str, tuple[Import, ...]]:
    """Return the digest of a file's syntax, and its imports, in one walk."""
    pieces: list[str] = []
    imports: list[Import] = []
    _spell(_tree(path, modified_ns), pieces, imports)
    return hashlib.sha256("".join(pieces).encode()).hexdigest(), tuple(imports)


@lru_cache(maxsize=1024)
def _imports(path: Path, modified_ns: int, name: str) -> tuple[str, ...]:
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    found: list[str] = []
    for node in _read(path, modified_ns)[1]:
        if isinstance(node, ast.Import):
            found.extend(alias.name for alias in node.names)
        else:
            found.extend(_imported_from(node, package))
    return tuple(dict.fromkeys(found))


def _imported_from(node: ast.ImportFrom, package: str) -> Iterator[str]:
    base = node.module or ""
    if node.level:
        parents = package.split(".")
        above = parents[: len(parents) - node.level + 1]
        base = ".".join([*above, base] if base else above)
    for alias in node.names:
        submodule = f"{base}.{alias.name}"
        yield submodule if alias.name != "*" and module_path(submodule) else base


def _spell(node: object, pieces: list[str], imports: list[Import]) -> None:
    """Append pieces of text that spell a syntax tree, the same under every Python version.

    And the imports that are met.
    """
    if isinstance(node, ast.AST):
        if isinstance(node, Import):
            imports.append(node)
        pieces.append(f"({type(node).__name__}")
        for field in node._fields:
            value = getattr(node, field, None)
            if value is None or value == [] or field in _NOT_CODE:
                continue
            pieces.append(f" {field}=")
            _spell(_without_docstring(node, field, value), pieces, imports)
        pieces.append(")")
    elif isinstance(node, list):
        pieces.append("[")
        for item in node:
            _spell(item, pieces, imports)
            pieces.append(",")
        pieces.append("]")
    else:
        pieces.append(f"{type(node).__name__}:{node!r}")


def _without_docstring(node: ast.AST, field: str, value: object) -> object:
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    if field != "body" or not isinstance(node, documented) or not isinstance(value, list):
        return value
    first = value[0]
    if (
        isinstance(first, ast.Expr)
        and isinstance(first.value, ast.Constant)
        and isinstance(first.value.value, str)
    ):
        return value[1:]
    return value
