"""Everything that writes, each on inputs small enough for a second or two.

The programs are the real ones, from their entry points on; where measuring takes long they are
given smaller things to measure (`tools.faults.kills.small`).
"""

from __future__ import annotations

import importlib
import os
import shutil
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import survey_data
from algorithms.calibration import saving
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.pipeline import Pipeline
from api.cli import command_line
from api.cli.asking import knowledge
from api.cli.commands import benchmark, deposit, survey  # noqa: F401 - imported before any fork
from api.cli.commands import compile as compile_command  # noqa: F401
from api.cli.commands import dataset as dataset_command
from api.cli.commands import gc as gc_command
from api.cli.commands import leaderboard as leaderboard_command
from api.deposit import bundle
from api.docs import documentation
from benchmark.experiments import __main__ as experiments_run
from benchmark.experiments.claims import Claims
from benchmark.experiments.error_budget import ErrorBudget
from benchmark.experiments.learning_curves import LearningCurves
from benchmark.plan.combinations import cells
from benchmark.processes import call_to_end
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running import compiling, pinning, runner
from benchmark.running import times as running_times
from benchmark.running.experiment import update
from benchmark.suites import tidying
from tools.faults.kills import small

#: A sensor of few numbers a sample.
_DATASET = "pd-maskless-cube"
_PAGE = "page.md"
_CLAIMS = ("C01", "C02", "C03", "C05")
_TABLES = Path(survey_data.__file__).parent


@dataclass(frozen=True)
class Command:
    """A program that writes.

    Attributes
    ----------
    what
        As it is called by people.
    prepare
        Makes what it starts from in an empty directory.
    act
        Runs the program to its end, which is a SystemExit; paths are relative to the directory.
    varying
        Names of files that hold times: their bytes differ each time.
    """

    what: str
    prepare: Callable[[], object]
    act: Callable[[], object]
    varying: tuple[str, ...] = ()


def sunatlas(*arguments: object) -> None:
    """Run the command line as its console script does."""
    sys.argv = ["sunatlas", *map(str, arguments)]
    command_line.main()


def program(work: Callable[[], object]) -> None:
    """Run a `python -m` of the project, or a call of its library, as they are run."""

    def main() -> int:
        work()
        return 0

    call_to_end(main)


def tables() -> None:
    """Copy the survey's tables, with an authors' table and a bibliography to import."""
    Path("tables").mkdir()
    for path in [*_TABLES.glob("*.csv"), _TABLES / "datapackage.json"]:
        shutil.copy(path, "tables")
    known = survey_data.load("tables")
    keys = [str(key) for key in known.studies["key"]]
    open_identity = known.studies.loc[known.studies["identity"] != "confirmed", "key"]
    Path("theirs.csv").write_text(
        "Key,Accuracy (deg)\n" + "".join(f"{k},0.{i + 11}\n" for i, k in enumerate(keys[:60])),
    )
    Path("others.csv").write_text(
        "Key,FOV (deg)\n" + "".join(f"{k},{i + 31}\n" for i, k in enumerate(keys[40:110])),
    )
    Path("refs.bib").write_text(
        "".join(
            f"@article{{{key}, title = {{A title of {key}}}, author = {{A. Writer}}}}\n"
            for key in open_identity[:20]
        )
    )


def save_calibration() -> None:
    """Calibrate a pipeline and save it."""
    draw = np.random.default_rng(1)
    sun = np.column_stack([draw.uniform(-0.5, 0.5, (400, 2)), np.ones(400)])
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    spots = 200.0 + 180.0 * sun[:, :2] / sun[:, 2:]
    pipeline = Pipeline(BasicCentroid(), SurfacePolynomial()).fit_features(spots, sun)
    for _ in range(40):
        saving.save(pipeline, "calibration.json")


def run_cells(*datasets: str) -> None:
    """Measure the cells of data sets into a store with two workers."""
    parts = small.parts()
    wanted = [one for one in cells(parts=parts) if not datasets or one.dataset in datasets]
    program(lambda: runner.run(wanted, Store("store"), 2, silent, parts=parts))


def filled() -> None:
    """A store with cells, pins and times, of which the code of today plans half."""
    parts = small.parts()
    runner.run(cells(parts=parts), Store("store"), 1, silent, parts=parts)


def pin(*names: str) -> None:
    """`sunatlas dataset pin` of a small store."""
    _give(dataset_command, "PUBLISHED", Path("store"))
    _give(pinning, "update", partial(pinning.update, parts=small.parts()))
    sunatlas("dataset", "pin", *names, "--workers", 2)


def update_leaderboard() -> None:
    """`sunatlas leaderboard update` of a small record; no sweep takes frames."""
    from benchmark.leaderboard import update as updating
    from benchmark.sweeps import plan as sweep_plan

    _give(sweep_plan, "_SERIES_OF", dict.fromkeys(sweep_plan._SERIES_OF, ()))
    _give(leaderboard_command, "PUBLISHED", Path("store"))
    _give(updating, "update", partial(updating.update, parts=small.parts()))
    sunatlas("leaderboard", "update", "--workers", 2)


def tidy() -> None:
    """`sunatlas gc` after one of two data sets has changed."""
    parts = small.parts()
    one = {"fake-diodes": parts.presets["fake-diodes"]}
    left = type(parts)(one, parts.extractors, parts.models)
    _give(gc_command, "tidy", partial(tidying.tidy, parts=left))
    sunatlas("gc", "--yes", "--store", "store")


def take_times() -> None:
    """`sunatlas leaderboard times` of a small plan."""
    _give(leaderboard_command, "PUBLISHED", Path("store"))
    _give(running_times, "installed_parts", small.parts)
    sunatlas("leaderboard", "times")


def compile_all() -> None:
    """`sunatlas compile` of a small plan, with two workers."""
    given = partial(compiling.compile_kernels, parts=small.few_parts(_DATASET))
    _give(compiling, "compile_kernels", given)
    sunatlas("compile", "--workers", 2)


def measure_claims(*names: str) -> None:
    """`python -m benchmark.experiments claims`, with two workers."""
    _give(Claims, "measure", staticmethod(small.claim))
    call = ["claims", *names, "--directory", "store", "--workers", "2"]
    program(lambda: experiments_run.main(call))


def learn() -> None:
    """`python -m benchmark.experiments learning_curves`, small, with two workers."""
    program(lambda: update(LearningCurves("store", small.curve_parts()), 2, silent))


def budget_errors(*datasets: str) -> None:
    """`python -m benchmark.experiments error_budget` of data sets that are given."""
    keys = {f"set-{n}": "of this code" for n in range(8)}
    _give(ErrorBudget, "keys", lambda _: keys)
    _give(ErrorBudget, "tasks", lambda _, cells: cells)
    _give(ErrorBudget, "measure", staticmethod(small.error_budget))
    program(lambda: update(ErrorBudget("store"), 1, silent, only=datasets or None))


def empty_docs() -> None:
    """A directory of documentation with one page."""
    Path("docs").mkdir()
    (Path("docs") / _PAGE).write_text("# A page\n\nNothing is run here.\n")


def document() -> None:
    """`python -m api.docs.documentation` of a few pictures, and a page without commands to run."""
    pictures = {f"{n}.svg": small.picture for n in range(12)}
    _give(documentation, "every_page", lambda _directory: {})
    _give(documentation, "RUN", (_PAGE,))
    _give(documentation, "every_picture", lambda: pictures)
    program(lambda: documentation.regenerate(Path("docs")))


def deposit_build() -> None:
    """`sunatlas deposit build` with samples of one data set; those of all take minutes."""
    _give(bundle, "build", partial(bundle.build, frames=(_DATASET,)))
    sunatlas("deposit", "build", "--out", "bundle")


def export(n: int) -> None:
    """`sunatlas dataset export`, over an earlier one."""
    split = ("--condition", "nominal", "--split", "test", "--split", "calibration")
    sunatlas("dataset", "export", _DATASET, "--n", n, *split, "--force", "--out", "exported")


def _give(module: Any, name: str, value: object) -> None:
    """Change a module in this process, which does nothing else afterwards."""
    setattr(module, name, value)


def _nothing() -> None:
    """Start from an empty directory."""


def _earlier(name: str) -> Callable[[], None]:
    """Start from what the command itself has made once."""
    return lambda: _to_end(COMMANDS[name].act)


def _to_end(act: Callable[[], object]) -> None:
    try:
        act()
    except SystemExit as ended:
        if ended.code:
            raise RuntimeError(f"it ended with {ended.code}") from ended


def preload(names: Collection[str]) -> None:
    """Read and import once what every child then has: the board that is rendered, libraries."""
    if "render" in names:
        _ = knowledge().measurements.leaderboard
    if any(name.startswith("deposit") for name in names):
        survey_data.validate()
        for library in ("pyarrow.parquet", "matplotlib.backends.backend_agg", "scipy.stats"):
            importlib.import_module(library)


COMMANDS: Mapping[str, Command] = {
    "import": Command(
        "`survey import --apply`",
        tables,
        lambda: sunatlas("survey", "import", "theirs.csv", "--apply", "--data", "tables"),
    ),
    "bibliography": Command(
        "`survey import --bibliography --apply`",
        tables,
        lambda: sunatlas(
            *("survey", "import", "--bibliography", "refs.bib", "--apply", "--data", "tables")
        ),
    ),
    "export": Command("`dataset export --force`", _earlier("export-first"), lambda: export(8)),
    "export-first": Command("`dataset export`", _nothing, lambda: export(5)),
    "preview": Command(
        "`dataset preview`",
        _nothing,
        lambda: sunatlas("dataset", "preview", _DATASET, "--out", "seen/preview.png"),
    ),
    "deposit": Command("`deposit build`", _nothing, deposit_build),
    "deposit-again": Command(
        "`deposit build` over an earlier one", _earlier("deposit"), deposit_build
    ),
    "pin": Command("`dataset pin`", _nothing, pin),
    "update": Command(
        "`leaderboard update`", _nothing, update_leaderboard, varying=("durations.csv",)
    ),
    "run": Command("`run`", _nothing, run_cells, varying=("durations.csv",)),
    "gc": Command("`gc --yes`", filled, tidy, varying=("durations.csv",)),
    "times": Command(
        "`leaderboard times`", _nothing, take_times, varying=("times.csv", "times_machine.json")
    ),
    "render": Command(
        "`leaderboard render`", _nothing, lambda: sunatlas("leaderboard", "render", "--out", "all")
    ),
    "compile": Command("`compile`", _nothing, compile_all),
    "claims": Command(
        "`python -m benchmark.experiments claims`", _nothing, lambda: measure_claims(*_CLAIMS)
    ),
    "curves": Command(
        "`python -m benchmark.experiments learning_curves`",
        lambda: small.write_scores(Path("store")),
        learn,
    ),
    "error_budget": Command(
        "`python -m benchmark.experiments error_budget`", _nothing, budget_errors
    ),
    "docs": Command("`python -m api.docs.documentation`", empty_docs, document),
    "save": Command("`calibration.saving.save`", _nothing, lambda: program(save_calibration)),
}

os.environ.setdefault("FAKE_ATLAS_SLEEP", str(small.STEP_S))
