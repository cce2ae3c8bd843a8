"""One source file as its top-level statements: a digest of each, and the names that it uses.

A digest is of the syntax tree: comments, docstrings, formatting and line numbers do not enter it.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable
from typing import Any, NamedTuple

from benchmark.results.syntax import (
    IMPORTED,
    Import,
    bound_names,
    last_name,
    outside_functions,
    spell,
    targets,
    uses,
)

#: Raised when `Definitions` means something else: analyses that were kept are made again.
VERSION = 1
#: Decorators that do nothing but to what they decorate.
_PLAIN_DECORATORS = frozenset(
    {
        "cache",
        "compiled",
        "contextmanager",
        "dataclass",
        "documented",
        "final",
        "lru_cache",
        "overload",
        "runtime_checkable",
        "tables",
        "total_ordering",
        "unique",
        "wraps",
    }
)
#: Metaclasses that register nothing.
_PLAIN_METACLASSES = frozenset({"ABCMeta", "EnumMeta", "EnumType", "type"})


class ClosureError(ValueError):
    """A module whose source is needed for a digest was not found or cannot be read."""


class Statement(NamedTuple):
    """A top-level statement: its digest, and what it uses.

    A use is a name of the module with the attributes that follow it (``np.linalg.norm``), an import
    (``=package.module.name``, ``=..sibling.name``; ``!=...`` where nothing is taken from it), or
    ``*`` for everything in the module.
    """

    digest: str
    uses: tuple[str, ...]


class Definitions(NamedTuple):
    """What a file defines, does and imports.

    Attributes
    ----------
    statements
        Top-level ones, but imports.
    names
        By name, the numbers of all statements that bind it, in order.
    effects
        Numbers of statements that do something when the module is imported, in order.
    bound
        By name that an import binds: what it may be bound to, as a use.
    stars
        Modules of which every name is imported, as uses.
    imports
        All that is imported when the module is, as uses.
    """

    statements: tuple[Statement, ...]
    names: dict[str, tuple[int, ...]]
    effects: tuple[int, ...]
    bound: dict[str, tuple[str, ...]]
    stars: tuple[str, ...]
    imports: tuple[str, ...]


def analyse(source: bytes, name: str) -> Definitions:
    """Take a source file apart.

    Parameters
    ----------
    source
        Its bytes.
    name
        Of the file, for errors.

    Raises
    ------
    ClosureError
        When it cannot be parsed.
    """
    try:
        tree = ast.parse(source, filename=name)
    except (SyntaxError, ValueError) as error:
        raise ClosureError(f"{name} cannot be parsed: {error}") from error
    return _Module(tree).definitions()


class _Module:
    """Collects what is in a module's body."""

    def __init__(self, tree: ast.Module) -> None:
        self.statements: list[Statement] = []
        self.names: dict[str, list[int]] = {}
        self.effects: list[int] = []
        self.bound: dict[str, list[str]] = {}
        self.stars: list[str] = []
        self.imports: list[str] = []
        for node in tree.body:
            self._add(node)

    def definitions(self) -> Definitions:
        return Definitions(
            tuple(self.statements),
            {name: tuple(numbers) for name, numbers in self.names.items()},
            tuple(self.effects),
            {name: tuple(dict.fromkeys(targets)) for name, targets in self.bound.items()},
            tuple(dict.fromkeys(self.stars)),
            tuple(dict.fromkeys(self.imports)),
        )

    def _add(self, node: ast.stmt) -> None:
        if isinstance(node, Import):
            self._bind(node, executed=True)
            return
        if _is_docstring(node) or isinstance(node, ast.Pass) or _is_test_of_main(node):
            return
        for inner in outside_functions(node):
            if isinstance(inner, Import):
                self._bind(inner, executed=not _is_for_type_checkers(node))
        number = len(self.statements)
        digest = hashlib.sha256(spell(node).encode()).hexdigest()[:32]
        self.statements.append(Statement(digest, uses(node)))
        for name in dict.fromkeys(bound_names(node)):
            self.names.setdefault(name, []).append(number)
        if _has_effect(node):
            self.effects.append(number)

    def _bind(self, node: Import, *, executed: bool) -> None:
        for name, target in targets(node):
            if name == "*":
                self.stars.append(target)
            else:
                self.bound.setdefault(name, []).append(target)
            if executed:
                self.imports.append(target)
        if executed and isinstance(node, ast.Import):
            self.imports.extend(f"{IMPORTED}{alias.name}" for alias in node.names)


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_for_type_checkers(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and last_name(node.test) == "TYPE_CHECKING"


def _is_test_of_main(node: ast.stmt) -> bool:
    """Say whether a statement is ``if __name__ == "__main__":``, which no import runs."""
    return (
        isinstance(node, ast.If)
        and not node.orelse
        and ast.unparse(node.test).replace('"', "'") == "__name__ == '__main__'"
    )


def _has_effect(node: ast.stmt) -> bool:
    """Say whether a statement may change more than the names that it binds."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        decorated = any(last_name(one) not in _PLAIN_DECORATORS for one in node.decorator_list)
        keywords = node.keywords if isinstance(node, ast.ClassDef) else []
        return decorated or any(last_name(k.value) not in _PLAIN_METACLASSES for k in keywords)
    if isinstance(node, ast.AnnAssign):
        return not isinstance(node.target, ast.Name)
    if isinstance(node, ast.Assign):
        return not all(_are_names(target) for target in node.targets)
    if isinstance(node, ast.If | ast.Try):
        handlers = node.handlers if isinstance(node, ast.Try) else []
        blocks = [node.body, node.orelse, *(one.body for one in handlers)]
        blocks += [node.finalbody] if isinstance(node, ast.Try) else []
        inner = [one for block in blocks for one in block]
        return any(not isinstance(one, Import | ast.Pass) and _has_effect(one) for one in inner)
    return not isinstance(node, Import | ast.Pass) and type(node).__name__ != "TypeAlias"


def _are_names(target: ast.expr) -> bool:
    if isinstance(target, ast.Tuple | ast.List):
        return all(map(_are_names, target.elts))
    return isinstance(target, ast.Name)


def from_json(held: Iterable[Any]) -> Definitions:
    """Return definitions as they were before JSON made lists of their tuples."""
    statements, names, effects, bound, stars, imports = held
    return Definitions(
        tuple(Statement(str(digest), tuple(uses)) for digest, uses in statements),
        {name: tuple(numbers) for name, numbers in names.items()},
        tuple(effects),
        {name: tuple(targets) for name, targets in bound.items()},
        tuple(stars),
        tuple(imports),
    )
