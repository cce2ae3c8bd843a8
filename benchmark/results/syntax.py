"""What a syntax tree says: its spelling, the names that it binds, those that it uses."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

#: Begins a use that is an absolute or relative import instead of a name of the module.
IMPORTED = "="
#: Begins a use that is an import of which only what it does when it is run matters.
LOADED = "!"
#: A use of everything in the module itself.
EVERYTHING = "*"

Import = ast.Import | ast.ImportFrom

#: Fields of syntax nodes that say how a thing was written, or that only some Python versions have.
_NOT_CODE = frozenset({"ctx", "kind", "type_comment", "type_ignores"})
#: Calls that can read any name of the module they stand in.
_READS_ALL = frozenset({"globals", "vars", "locals", "eval", "exec"})

_Function = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
_Comprehension = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
#: Names of a function, with what imports bind them to.
_Scope = dict[str, tuple[str, ...]]
_Scopes = tuple[_Scope, ...]


def targets(node: Import) -> Iterator[tuple[str, str]]:
    """Yield the names that an import binds, each with what to."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            if alias.asname:
                yield alias.asname, f"{IMPORTED}{alias.name}"
            else:
                top = alias.name.partition(".")[0]
                yield top, f"{IMPORTED}{top}"
        return
    base = "." * node.level + (node.module or "")
    for alias in node.names:
        if alias.name == "*":
            yield "*", f"{IMPORTED}{base}"
        else:
            between = "" if base.endswith(".") else "."
            yield alias.asname or alias.name, f"{IMPORTED}{base}{between}{alias.name}"


def last_name(node: ast.expr) -> str:
    """Return the last name of ``a.b.c`` or ``a.b.c(...)``; empty for anything else."""
    if isinstance(node, ast.Call):
        return last_name(node.func)
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def outside_functions(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a statement's nodes that are run when it is: none in bodies of functions."""
    yield node
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
        return
    for child in ast.iter_child_nodes(node):
        yield from outside_functions(child)


def bound_names(node: ast.AST) -> Iterator[str]:
    """Yield names that a statement binds or deletes in its own scope."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name
        return
    if isinstance(node, _Comprehension | ast.Lambda):
        return
    if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
        yield node.id
    if isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar) and node.name:
        yield node.name
    if isinstance(node, ast.MatchMapping) and node.rest:
        yield node.rest
    for child in ast.iter_child_nodes(node):
        yield from bound_names(child)


def uses(node: ast.AST) -> tuple[str, ...]:
    """Return what a statement uses of its module and of others, sorted."""
    found: set[str] = set()
    _Uses(found).visit(node, ())
    return tuple(sorted(found))


class _Uses:
    """Walks a statement with the scopes around each node; names that are local are not counted."""

    def __init__(self, found: set[str]) -> None:
        self.found = found

    def visit(self, node: ast.AST, scopes: _Scopes) -> None:
        if isinstance(node, _Function):
            self._function(node, scopes)
        elif isinstance(node, _Comprehension):
            bound = (name for one in node.generators for name in bound_names(one.target))
            local: _Scope = dict.fromkeys(bound, ())
            # the first iterable is evaluated outside
            self.visit(node.generators[0].iter, scopes)
            self._children(node, (*scopes, local))
        elif isinstance(node, Import):
            for name, target in targets(node):
                if name == "*":
                    self.found.add(f"{target}.{EVERYTHING}")
                else:  # in a function, those that are used are found where they are
                    self.found.add(LOADED + target if scopes else target)
        elif isinstance(node, ast.Attribute | ast.Name):
            self._chain(node, scopes)
        else:
            if isinstance(node, ast.Call):
                self._call(node)
            elif isinstance(node, ast.Global):
                self.found.update(node.names)
            self._children(node, scopes)

    def _children(self, node: ast.AST, scopes: _Scopes) -> None:
        for child in ast.iter_child_nodes(node):
            self.visit(child, scopes)

    def _function(self, node: _Function, scopes: _Scopes) -> None:
        arguments = node.args
        outside: list[ast.AST] = [*arguments.defaults, *filter(None, arguments.kw_defaults)]
        every = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
        every += filter(None, (arguments.vararg, arguments.kwarg))
        outside += [one.annotation for one in every if one.annotation]
        body: list[ast.AST]
        if isinstance(node, ast.Lambda):
            body = [node.body]
        else:
            outside += [*node.decorator_list, *filter(None, [node.returns])]
            outside += getattr(node, "type_params", [])
            body = [*node.body]
        for one in outside:
            self.visit(one, scopes)
        local: dict[str, tuple[str, ...]] = {one.arg: () for one in every}
        local.update((name, ()) for one in body for name in bound_names(one))
        shared: set[str] = set()
        for one in body:
            for inner in outside_functions(one):
                if isinstance(inner, ast.Global | ast.Nonlocal):
                    shared.update(inner.names)
                elif isinstance(inner, Import):
                    for name, target in targets(inner):
                        if name != "*":
                            local[name] = (*local.get(name, ()), target)
        inside = (*scopes, {name: to for name, to in local.items() if name not in shared})
        for one in body:
            self.visit(one, inside)

    def _chain(self, node: ast.expr, scopes: _Scopes) -> None:
        attributes: list[str] = []
        while isinstance(node, ast.Attribute):
            attributes.append(node.attr)
            node = node.value
        if not isinstance(node, ast.Name):
            self.visit(node, scopes)
            return
        if not isinstance(node.ctx, ast.Load):  # what a statement binds is no use
            return
        chain = ".".join(["", *reversed(attributes)])
        for scope in reversed(scopes):
            if node.id in scope:
                self.found.update(f"{target}{chain}" for target in scope[node.id])
                return
        self.found.add(f"{node.id}{chain}")

    def _call(self, node: ast.Call) -> None:
        called = last_name(node.func)
        if called in _READS_ALL and isinstance(node.func, ast.Name):
            if called != "vars" or not node.args:
                self.found.add(EVERYTHING)
        elif called in ("import_module", "__import__"):
            first: Any = node.args[0] if node.args else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                self.found.add(f"{IMPORTED}{first.value}")


def spell(tree: ast.AST) -> str:
    """Spell a syntax tree, the same under every Python version and without docstrings."""
    pieces: list[str] = []
    _spell(tree, pieces)
    return "".join(pieces)


def _spell(node: object, pieces: list[str]) -> None:
    if isinstance(node, ast.AST):
        pieces.append(f"({type(node).__name__}")
        for field in node._fields:
            value = getattr(node, field, None)
            if value is None or value == [] or field in _NOT_CODE:
                continue
            pieces.append(f" {field}=")
            _spell(_without_docstring(node, field, value), pieces)
        pieces.append(")")
    elif isinstance(node, list):
        pieces.append("[")
        for item in node:
            _spell(item, pieces)
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
