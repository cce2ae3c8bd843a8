"""Mutation testing by Cosmic Ray: a drawn sample, and the tests of the mutant that is in place.

`python -m tools.mutants draw DIRECTORY --number 100 --seed N` writes a configuration and a session
of so many mutants, each of another module, drawn with the modules' lengths as weights; `cosmic-ray
exec` tries them. `python -m tools.mutants test` runs the tests of the modules that differ from git.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import WorkItem

ROOT = Path(__file__).resolve().parents[1]
CONFIG = Path(__file__).with_name("cosmic-ray.toml")
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")
#: They compare digests of the code, or what it draws, with what is committed: red at any change.
_AT_ANY_CHANGE = ("test_leaderboard_published.py", "test_documentation.py", "test_pictures.py")
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
    command = [Path(sys.executable).with_name("cosmic-ray"), "init", config, session]
    subprocess.run(command, cwd=ROOT, check=True)
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


def tests_of(module: str) -> list[Path]:
    """Return the test files that import a module, then those of its folder's tests.

    Of a module that no test imports, such as a kernel, those that import one that does.
    """
    every = [p for p in sorted((ROOT / "tests").rglob("test_*.py")) if p.name not in _AT_ANY_CHANGE]
    found = _importing(module, every)
    if not found:
        for user in _importing(
            module, [p for floor in FLOORS for p in (ROOT / floor).rglob("*.py")]
        ):
            found += _importing(user.relative_to(ROOT).as_posix(), every)
    folder = Path("tests", module).parent
    while not (ROOT / folder).is_dir():
        folder = folder.parent
    beside = [path for path in every if path.is_relative_to(ROOT / folder)]
    # which import what they discover
    if module.startswith("algorithms/"):
        beside.append(ROOT / "tests/algorithms/test_common_suite.py")
        beside.append(ROOT / "tests/benchmark/running/test_published_cells.py")
    if module.startswith(("benchmark/simulator/", "benchmark/datasets/")):
        beside.append(ROOT / "tests/benchmark/datasets/test_published_heads.py")
    return list(dict.fromkeys(found + beside))


def _importing(module: str, files: list[Path]) -> list[Path]:
    package, _, name = module.removesuffix(".py").replace("/", ".").rpartition(".")
    imports = re.compile(
        rf"^\s*(?:from {package}\.{name} import|import {package}\.{name}\b"
        rf"|from {package} import .*\b{name}\b)",
        re.MULTILINE,
    )
    return [path for path in files if imports.search(path.read_text("utf-8"))]


def test() -> int:
    """Run the tests of what differs from git; the exit status is that of pytest."""
    command = ["git", "diff", "--name-only", "--", *FLOORS]
    changed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    files = [path for module in changed.stdout.split() for path in tests_of(module)]
    if not files:
        return 0
    pytest = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    return subprocess.run([*pytest, "-m", "not slow", *files], cwd=ROOT, check=False).returncode


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
