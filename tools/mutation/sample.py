"""Which mutants are tried: a fixed sample that unrelated edits leave as it is."""

from __future__ import annotations

import ast
import hashlib
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.ast.ast_query import ASTQuery
from cosmic_ray.plugins import get_operator

#: Enters every draw: another seed is another sample.
SEED = "2"

_BINARY = {
    "Add": ("Sub",),
    "Sub": ("Add",),
    "Mul": ("Div",),
    "Div": ("Mul",),
    "FloorDiv": ("Mul",),
    "Mod": ("FloorDiv",),
    "Pow": ("Mul",),
    "BitAnd": ("BitOr",),
    "BitOr": ("BitAnd",),
    "BitXor": ("BitOr",),
    "LShift": ("RShift",),
    "RShift": ("LShift",),
}
_COMPARISONS = {
    "Eq": ("NotEq",),
    "NotEq": ("Eq",),
    "Lt": ("LtE", "GtE"),
    "LtE": ("Lt", "Gt"),
    "Gt": ("GtE", "LtE"),
    "GtE": ("Gt", "Lt"),
    "Is": ("IsNot",),
    "IsNot": ("Is",),
}
#: Cosmic Ray's operators that are drawn from, by family: signs, boundaries, guards, constants.
FAMILIES: dict[str, tuple[str, ...]] = {
    "arithmetic": tuple(
        f"ReplaceBinaryOperator_{one}_{to}" for one, others in _BINARY.items() for to in others
    ),
    "comparison": tuple(
        f"ReplaceComparisonOperator_{one}_{to}"
        for one, others in _COMPARISONS.items()
        for to in others
    ),
    "unary": tuple(f"ReplaceUnaryOperator_Delete_{one}" for one in ("USub", "Not", "Invert")),
    "logic": (
        *("ReplaceAndWithOr", "ReplaceOrWithAnd", "AddNot"),
        *("ReplaceTrueWithFalse", "ReplaceFalseWithTrue"),
    ),
    "number": ("NumberReplacer",),
    "flow": (
        *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak"),
        *("ZeroIterationForLoop", "ExceptionReplacer"),
    ),
}
#: Nodes of a syntax tree whose operators are arithmetic: not a lone `*` or what unpacks.
_ARITHMETIC = frozenset({"arith_expr", "term", "expr", "and_expr", "xor_expr", "shift_expr"}) | {
    "power"
}

Place = tuple[int, int]  # (line from 1, column from 0)


@dataclass(frozen=True)
class Mutant:
    """One fault that may be put into one module.

    Attributes
    ----------
    key
        Digest of what it does to which line of which definition: its name and its place in the
        order of the draw. Line numbers do not enter.
    """

    key: str
    module: str
    family: str
    operator: str
    occurrence: int
    start: Place
    end: Place
    definition: str


def draw(root: Path, modules: Sequence[str], count: int) -> list[Mutant]:
    """Draw `count` mutants of a group of modules (fewer where there are not as many).

    A module's share goes by the root of the number of places where it can be changed, so that a
    long one does not crowd out the others. In a module the families take turns; in a family, and
    among the changes of one place, the smallest key is first.
    """
    ordered = {module: _in_turns(list(mutants(root, module))) for module in modules}
    taken: dict[str, int] = dict.fromkeys(ordered, 0)
    for _ in range(count):
        open_still = [name for name, found in ordered.items() if taken[name] < len(found)]
        if not open_still:
            break
        # whoever is furthest behind its share: as seats are given to parties
        behind = min(open_still, key=lambda n: ((taken[n] + 0.5) / math.sqrt(len(ordered[n])), n))
        taken[behind] += 1
    return [mutant for name, found in ordered.items() for mutant in found[: taken[name]]]


def mutants(root: Path, module: str) -> Iterator[Mutant]:
    """Yield every mutant of a module that changes what it does, not what it says of itself."""
    source = (root / module).read_text()
    lines = source.splitlines()
    spared = list(_spared(ast.parse(source)))
    nodes = list(ast_nodes(get_ast(source)))
    met: dict[tuple[str, ...], int] = defaultdict(int)
    for family, names in FAMILIES.items():
        for name in names:
            operator = get_operator(f"core/{name}")()
            places = (
                (node, start, end)
                for node in nodes
                for start, end in operator.mutation_positions(node)
            )
            for occurrence, (node, start, end) in enumerate(places):
                if any(first <= start < last for first, last in spared):
                    continue
                if family == "arithmetic" and node.parent.type not in _ARITHMETIC:
                    continue
                definition = ASTQuery(node).get_definition_name() or ""
                words = (module, name, definition, lines[start[0] - 1].strip())
                met[words] += 1
                spelt = "\0".join((SEED, *words, str(met[words])))
                key = hashlib.sha256(spelt.encode()).hexdigest()[:16]
                yield Mutant(key, module, family, name, occurrence, start, end, definition)


def _in_turns(found: list[Mutant]) -> list[Mutant]:
    """Order mutants, one a place and family, the families in turns."""
    first_at: dict[tuple[str, Place], Mutant] = {}
    for mutant in sorted(found, key=lambda one: one.key):
        first_at.setdefault((mutant.family, mutant.start), mutant)
    turn: dict[str, int] = defaultdict(int)
    ranked = []
    for mutant in first_at.values():
        ranked.append((turn[mutant.family], mutant.key, mutant))
        turn[mutant.family] += 1
    return [mutant for *_, mutant in sorted(ranked, key=lambda one: one[:2])]


def _spared(tree: ast.Module) -> Iterator[tuple[Place, Place]]:
    """Spans of what a test has no business with: types, decorators, messages, versions."""
    for node in ast.walk(tree):
        for part in (*_types_in(node), *_words_in(node)):
            if part is not None:
                yield _start(part), _end(part)


def _types_in(node: ast.AST) -> Sequence[ast.AST | None]:
    if isinstance(node, ast.arg):
        return [node.annotation]
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        rest = node.bases if isinstance(node, ast.ClassDef) else [node.returns]
        return [*node.decorator_list, *rest]
    if isinstance(node, ast.Assign):
        return [node] if _is_type(node.value) else []
    if isinstance(node, ast.AnnAssign):
        facts = "ClassVar" in ast.unparse(node.annotation)  # what the catalogue shows
        shown = isinstance(node.value, ast.Call) and ast.unparse(node.value.func) == "field"
        return [node if facts or shown else node.annotation]
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance":
        return node.args[1:]
    return []


def _words_in(node: ast.AST) -> Sequence[ast.AST | None]:
    if isinstance(node, ast.Raise):
        return [node]
    if isinstance(node, ast.Assign):
        return [node] if ast.unparse(node.targets[0]) == "__all__" else []
    if isinstance(node, ast.If):
        return [node] if ast.unparse(node.test) == "TYPE_CHECKING" else []
    if isinstance(node, ast.keyword):
        return [node.value] if node.arg == "strict" else []  # of zip: lengths that never differ
    return []


def _is_type(value: ast.AST) -> bool:
    """Say whether an assigned value is a union of types: an alias."""
    return (
        isinstance(value, ast.BinOp)
        and isinstance(value.op, ast.BitOr)
        and all(
            isinstance(one, ast.Name | ast.Attribute | ast.Subscript) or _is_type(one)
            for one in (value.left, value.right)
        )
    )


def _start(node: ast.AST) -> Place:
    return (int(node.lineno), int(node.col_offset))  # type: ignore[attr-defined]


def _end(node: ast.AST) -> Place:
    return (int(node.end_lineno), int(node.end_col_offset))  # type: ignore[attr-defined]
