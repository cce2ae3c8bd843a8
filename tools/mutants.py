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
from functools import cache
from pathlib import Path

from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import WorkItem

ROOT = Path(__file__).resolve().parents[1]
CONFIG = Path(__file__).with_name("cosmic-ray.toml")
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")
#: They compare digests of the code, or what it draws, with what is committed: red at any change.
_AT_ANY_CHANGE = (
    "api/docs/test_documentation.py",
    "api/test_pictures.py",
    "benchmark/as_sold/test_measure.py::test_the_published_rows_are_of_the_code",
    "benchmark/leaderboard/test_leaderboard_published.py::test_the_record_is_of_the_code_as_it_is",
    "benchmark/leaderboard/test_study_record.py::test_the_record_is_as_its_commands_wrote_it",
)
#: Tests that reach what discovery finds, what a command names and what a page shows, by floor.
_MEASURING = (
    "benchmark/running/test_published_cells.py",
    "benchmark/claims/test_trials_measured.py",
)
_REACHING = {
    ("algorithms/",): ("algorithms/test_common_suite.py", *_MEASURING),
    ("benchmark/simulator/", "benchmark/datasets/"): (
        "benchmark/datasets/test_published_heads.py",
        *_MEASURING,
    ),
    ("benchmark/",): (
        "benchmark/test_experiment_plots.py",
        "benchmark/claims/test_trials_measured.py",
        "benchmark/sweeps",
        "benchmark/leaderboard",
    ),
    ("api/",): tuple(f"api/{face}" for face in ("pages", "figures", "service", "http", "cli")),
}
#: Of what they import alone: they wait for servers, and for processes behind all others.
_WAITING = re.compile(
    r"/api/server/|/test_(http_calibrations|http_hanging_up|http_uploads|upload_callers)\.py$"
)
#: Test files by way of users, which are many of a module that much is built on.
_MANY = 40
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


def tests_of(module: str) -> tuple[list[Path], list[Path]]:
    """Return the test files that are near a module, and further ones, the nearest first.

    Near are those that import it, and those of its folder and of the folders above. Further are
    those that import what uses it, step by step up to `_MANY`, and those of `_REACHING`.
    """
    every = [
        path
        for path in sorted((ROOT / "tests").rglob("test_*.py"))
        if path.parent.name != "browser"
    ]
    sources = [path for floor in FLOORS for path in sorted((ROOT / floor).rglob("*.py"))]
    near = _importing(module, every)
    every = [path for path in every if not _WAITING.search(path.as_posix())]
    for folder in Path("tests", module).parents[:-2]:  # down to that of the floor
        near += [path for path in every if path.parent == ROOT / folder]
    further: list[Path] = []
    users, known = [module], {module}
    while users and len(set(further)) < _MANY:
        using = dict.fromkeys(p for user in users for p in _importing(user, sources))
        users = [u for p in using if (u := p.relative_to(ROOT).as_posix()) not in known]
        known.update(users)
        for user in users:
            further += _importing(user, every)
            if len(set(further)) >= _MANY:
                break
    further = list(dict.fromkeys(further))[:_MANY]
    for floors, places in _REACHING.items():
        if module.startswith(floors):
            reaching = [ROOT / "tests" / place for place in places]
            further += [p for place in reaching for p in every if p.is_relative_to(place)]
    near = list(dict.fromkeys(near))
    return near, [path for path in dict.fromkeys(further) if path not in near]


def _importing(module: str, files: list[Path]) -> list[Path]:
    dotted = module.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    package, _, name = dotted.rpartition(".")
    imports = re.compile(
        rf"^\s*(?:from {dotted} import|import {dotted}\b"
        rf"|from {package} import (?:\([^)]*|.*)\b{name}\b)",
        re.MULTILINE,
    )
    return [path for path in files if name in (text := _text(path)) and imports.search(text)]


@cache
def _text(path: Path) -> str:
    return path.read_text("utf-8")


def test() -> int:
    """Run the tests of what differs from git; the exit status is that of pytest.

    The further ones are run where the near ones notice nothing.
    """
    command = ["git", "diff", "--name-only", "--", *FLOORS]
    changed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    pytest = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
        "-m",
        "not slow",
    ]
    pytest += [f"--deselect=tests/{place}" for place in _AT_ANY_CHANGE]
    for files in zip(*(tests_of(module) for module in changed.stdout.split()), strict=True):
        chosen = list(dict.fromkeys(path for of_module in files for path in of_module))
        if not chosen:
            continue
        done = subprocess.run([*pytest, *chosen], cwd=ROOT, check=False)
        if done.returncode not in {0, _ALL_SLOW}:
            return done.returncode
    return 0


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
