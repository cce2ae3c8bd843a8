"""Mutation testing by Cosmic Ray: a drawn sample, and the tests that reach the mutant in place.

`python -m tools.mutants draw DIRECTORY --number 100 --seed N` writes a configuration and a session
of so many mutants, each of another module, drawn with the modules' lengths as weights; `cosmic-ray
exec` tries them. `python -m tools.mutants test` runs the tests that reach what differs from git, by
what coverage noted of them in `REACHED` (`make mutants` writes it).
"""

from __future__ import annotations

import argparse
import ast
import random
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from os.path import commonpath
from pathlib import Path

from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import WorkItem
from coverage import CoverageData

ROOT = Path(__file__).resolve().parents[1]
CONFIG = Path(__file__).with_name("cosmic-ray.toml")
#: Which tests ran which lines, as `pytest --cov --cov-context=test` writes it.
REACHED = ROOT / "out" / "reached.coverage"
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")
#: They compare digests of the code, or what it draws, with what is committed: red at any change.
_AT_ANY_CHANGE = re.compile(r"^tests/api/(docs/test_documentation|test_pictures)\.py")
_NOT_THEM = "not test_the_published_rows_are_of_the_code and not test_the_record_is_"
#: They wait for servers, and for processes behind all others: tried last.
_WAITING = re.compile(
    r"/api/server/|/test_(http_calibrations|http_hanging_up|http_uploads|upload_callers)\.py"
)
#: Tests that a mutant is tried with at most; examples of one test that come before other tests.
_MANY, _EXAMPLES = 240, 2
#: How far a kernel's or a constant's users are followed, where no test ran the line itself.
_STEPS = 4
#: What pytest exits with where it was given no test that is not slow.
_ALL_SLOW = 5
#: Type hints and what is declared alone; the next mutant of the module is taken.
_WITHOUT_EFFECT = re.compile(r"RemoveDecorator|BinaryOperator_BitOr")


def modules(number: int, seed: int) -> list[Path]:
    """Return so many modules of the floors, longer ones more often; no constants of data sets."""
    found = [
        path.relative_to(ROOT)
        for floor in FLOORS
        for path in sorted((ROOT / floor).rglob("*.py"))
        if not path.name.startswith("__") and path.parent.name not in {"conditions", "standard"}
    ]
    rng = random.Random(seed)
    place = {path: rng.random() ** (1 / (path.stat().st_size + 1)) for path in found}
    return sorted(sorted(found, key=lambda path: place[path])[-number:])


def draw(directory: Path, number: int, seed: int) -> None:
    """Write `cosmic-ray.toml` and `session.sqlite` with one mutant of each drawn module."""
    drawn = modules(number + number // 5 + 1, seed)  # some have nothing to change
    names = ", ".join(f'"{path.as_posix()}"' for path in drawn)
    config = directory / "cosmic-ray.toml"
    directory.mkdir(parents=True, exist_ok=True)
    config.write_text(CONFIG.read_text().replace("module-path = []", f"module-path = [{names}]"))
    assert tomllib.loads(config.read_text())["cosmic-ray"]["module-path"]
    session = directory / "session.sqlite"
    session.unlink(missing_ok=True)
    program = Path(sys.executable).with_name("cosmic-ray")
    subprocess.run([program, "init", config, session], cwd=ROOT, check=True)
    rng = random.Random(seed)
    with use_db(str(session), WorkDB.Mode.open) as database:
        of_module: dict[Path, list[WorkItem]] = {}
        for item in database.work_items:
            mutation = item.mutations[0]
            if not _WITHOUT_EFFECT.search(mutation.operator_name):
                of_module.setdefault(mutation.module_path, []).append(item)
        each = [rng.choice(items) for _, items in sorted(of_module.items())]
        kept = rng.sample(each, min(number, len(each)))
        database.clear()
        database.add_work_items(kept)
    sys.stdout.write(f"{len(kept)} mutants, seed {seed}\n")


def tests_of(module: str, lines: Iterable[int]) -> list[str]:
    """Return the tests that reach lines of a module, of its own folder first.

    Those that ran one of the lines. Where there are none, as with compiled kernels and what is
    read at import, those that ran a line that names what the lines define, and so on for what that
    line defines; before them whole test files that import the module.
    """
    places = {(module, number) for line in lines for number in _statement(module, line)}
    tests = {test for file, line in places for test in _ran(file).get(line, ())}
    near = [] if tests else _importing(module)
    seen: set[tuple[str, str]] = set()
    for _ in range(_STEPS):
        if tests:
            break
        names = {(file, name) for file, line in places for name in _defined(file, line)} - seen
        seen |= names
        places = {place for file, name in names for place in _named(file, name)}
        tests = {test for file, line in places for test in _ran(file).get(line, ())}
    tests = {test for test in tests if not _AT_ANY_CHANGE.search(test)}
    return near + [test for test in _ordered(tests, module) if test.partition("::")[0] not in near]


def _ordered(tests: Iterable[str], module: str) -> list[str]:
    """Return the first of them: a few examples of each test, of near folders before far ones."""
    of_function: dict[str, list[str]] = {}
    for test in sorted(tests):
        of_function.setdefault(test.partition("[")[0], []).append(test)
    folder = f"tests/{module}"

    def distance(test: str) -> tuple[bool, int]:
        shared = commonpath([test.partition("::")[0], folder])
        return bool(_WAITING.search(test)), -len(shared)

    few = [test for examples in of_function.values() for test in examples[:_EXAMPLES]]
    rest = [test for examples in of_function.values() for test in examples[_EXAMPLES:]]
    return [*sorted(few, key=distance), *sorted(rest, key=distance)][:_MANY]


@cache
def _measured() -> CoverageData:
    if not REACHED.exists():
        sys.exit(f"no {REACHED.relative_to(ROOT)}: `make mutants` runs the tests under coverage")
    data = CoverageData(str(REACHED))
    data.read()
    return data


@cache
def _ran(file: str) -> Mapping[int, list[str]]:
    """Return the tests that ran each line of a file's functions; what runs at import is of none.

    Where a fixture ran it, the whole file of the first test that asked for the fixture.
    """
    within: set[int] = set()
    for node in _statements(file):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            within.update(range(node.body[0].lineno, (node.end_lineno or node.lineno) + 1))
    return {
        line: [_asked(name) for name in names if name]
        for line, names in _measured().contexts_by_lineno(str(ROOT / file)).items()
        if line in within
    }


def _asked(context: str) -> str:
    """Return a test, or its file where its fixtures ran: they may be shared."""
    test, _, phase = context.rpartition("|")
    return test if phase == "run" else test.partition("::")[0]


@cache
def _sources() -> dict[str, str]:
    return {
        path.relative_to(ROOT).as_posix(): path.read_text("utf-8")
        for floor in FLOORS
        for path in sorted((ROOT / floor).rglob("*.py"))
    }


def _named(module: str, name: str) -> Iterator[tuple[str, int]]:
    """Give every line that names what a module defines, in it and where it is imported."""
    word, imports = re.compile(rf"\b{re.escape(name)}\b"), _imports(module)
    for file, text in _sources().items():
        if file == module or (name[0] != "_" and name in text and imports.search(text)):
            for number, line in enumerate(text.splitlines(), 1):
                if word.search(line):
                    yield file, number


@cache
def _statements(file: str) -> list[ast.stmt]:
    tree = ast.parse(_sources()[file])
    return [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]


def _around(file: str, line: int) -> list[ast.stmt]:
    """Return the statements around a line, the outermost first."""
    return [
        node
        for node in _statements(file)
        if node.lineno <= line <= (node.end_lineno or node.lineno)
    ]


def _statement(file: str, line: int) -> range:
    """Return the lines of the statement that a line is of, without the body below its head."""
    around = _around(file, line)
    if not around:
        return range(line, line + 1)
    node = around[-1]
    body = getattr(node, "body", None)
    end = body[0].lineno if body else (node.end_lineno or line) + 1
    return range(node.lineno, max(end, line + 1))


def _defined(file: str, line: int) -> Iterator[str]:
    """Give the names of the function around a line, or of what it assigns and the class around."""
    around = _around(file, line)
    functions = [node for node in around if isinstance(node, ast.FunctionDef)]
    if functions:
        yield functions[0].name
        return
    for node in around:
        if isinstance(node, ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))


def _imports(module: str) -> re.Pattern[str]:
    dotted = module.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    package, _, name = dotted.rpartition(".")
    return re.compile(
        rf"^\s*(?:from {dotted} import|import {dotted}\b"
        rf"|from {package} import (?:\([^)]*|.*)\b{name}\b)",
        re.MULTILINE,
    )


def _importing(module: str) -> list[str]:
    """Return the test files that import a module."""
    imports = _imports(module)
    files = [
        path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "tests").rglob("test_*.py"))
    ]
    return [
        file
        for file in files
        if "/browser/" not in file
        and not _AT_ANY_CHANGE.search(file)
        and imports.search((ROOT / file).read_text("utf-8"))
    ]


def _changed() -> dict[str, list[int]]:
    """Return the lines that differ from git, as they were, by file."""
    command = ["git", "diff", "--unified=0", "--", *FLOORS]
    text = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    found: dict[str, list[int]] = {}
    lines: list[int] = []
    for line in text.splitlines():
        if line.startswith("--- a/"):
            lines = found.setdefault(line[6:], [])
        elif at := re.match(r"@@ -(\d+)(?:,(\d+))? ", line):
            first, count = int(at[1]), int(at[2] or 1)
            lines.extend(range(first, first + max(count, 1)))
    return found


def test() -> int:
    """Run the tests that reach what differs from git; the exit status is that of pytest."""
    chosen = dict.fromkeys(
        t for module, lines in _changed().items() for t in tests_of(module, lines)
    )
    if not chosen:
        return 0
    options = ["-x", "-q", "-p", "no:cacheprovider", "-m", "not slow", "-k", _NOT_THEM]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *chosen], cwd=ROOT, check=False
    )
    return 0 if done.returncode == _ALL_SLOW else done.returncode


def main() -> int:
    """Draw, or test."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    drawing = verbs.add_parser("draw")
    drawing.add_argument("directory", type=Path)
    drawing.add_argument("--number", type=int, default=100)
    drawing.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    verbs.add_parser("test")
    given = parser.parse_args()
    if given.verb == "test":
        return test()
    draw(given.directory, given.number, given.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
