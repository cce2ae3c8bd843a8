"""What code a result depends on: the first-party modules reached, digested as syntax trees.

The closure is found without importing anything, by walking import statements (those inside
functions too). Comments, docstrings, formatting and line numbers do not enter the digest.
Modules found at run time only (`importlib.import_module`, `pkgutil`) are not followed.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

FIRST_PARTY = ("survey_data", "algorithms", "registry", "benchmark", "api")

# Fields of syntax nodes that say how a thing was written, or that only some Python versions have.
_NOT_CODE = frozenset({"ctx", "kind", "type_comment", "type_ignores"})


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
    return _syntax_digest(path, path.stat().st_mtime_ns)


def module_path(name: str) -> Path | None:
    """Source file of a module, found without importing it; None where there is none."""
    top, *rest = name.split(".")
    for root in _package_directories(top):
        base = root.joinpath(*rest)
        for candidate in (base / "__init__.py", base.with_suffix(".py")):
            if candidate.is_file():
                return candidate
    return None


def _package_directories(top: str) -> list[Path]:
    spec = importlib.util.find_spec(top)
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        return [Path(location) for location in spec.submodule_search_locations]
    return [Path(spec.origin).with_suffix("")] if spec.origin else []


@lru_cache(maxsize=1024)
def _tree(path: Path, modified_ns: int) -> ast.Module:  # noqa: ARG001 - the time is the cache's key
    try:
        return ast.parse(path.read_bytes(), filename=str(path))
    except (SyntaxError, ValueError) as error:
        raise ClosureError(f"{path} cannot be parsed: {error}") from error


@lru_cache(maxsize=1024)
def _syntax_digest(path: Path, modified_ns: int) -> str:
    text = "".join(_canonical(_tree(path, modified_ns)))
    return hashlib.sha256(text.encode()).hexdigest()


@lru_cache(maxsize=1024)
def _imports(path: Path, modified_ns: int, name: str) -> tuple[str, ...]:
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    found: list[str] = []
    for node in ast.walk(_tree(path, modified_ns)):
        if isinstance(node, ast.Import):
            found.extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
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


def _canonical(node: object) -> Iterator[str]:
    """Pieces of text that spell a syntax tree, the same under every Python version."""
    if isinstance(node, ast.AST):
        yield f"({type(node).__name__}"
        for field, value in ast.iter_fields(node):
            if field in _NOT_CODE or value is None or value == []:
                continue
            yield f" {field}="
            yield from _canonical(_without_docstring(node, field, value))
        yield ")"
    elif isinstance(node, list):
        yield "["
        for item in node:
            yield from _canonical(item)
            yield ","
        yield "]"
    else:
        yield f"{type(node).__name__}:{node!r}"


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
