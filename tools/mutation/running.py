"""Trying mutants: each in a copy of the tree, by a process of its own forked from this one.

Starting Python and importing NumPy, SciPy, pandas and Numba takes longer than most tests that
catch a fault. So this process imports them once, never the project itself, and forks.
"""

from __future__ import annotations

import importlib
import json
import os
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import hypothesis
import pytest
from cosmic_ray.mutating import apply_mutation
from cosmic_ray.plugins import get_operator

from tools.mutation.sample import Mutant

#: Third-party modules worth importing once. None of them starts a thread.
_HEAVY = (
    *("numpy", "pandas", "numba", "joblib", "_pytest.python"),
    *("hypothesis.strategies", "hypothesis.extra.numpy"),
    *("scipy.fft", "scipy.integrate", "scipy.interpolate", "scipy.linalg", "scipy.ndimage"),
    *("scipy.optimize", "scipy.signal", "scipy.spatial", "scipy.special", "scipy.stats"),
)
_NOT_COPIED = (".git", ".venv", "node_modules", ".*_cache", ".hypothesis", "*.egg-info")
#: Seconds a mutant has beside twice what its tests take: for compiling changed kernels.
_SPARE = 60.0
#: Left out: Monte Carlo of tens of seconds, which a mutant run cannot afford.
_QUICK = "not slow and not maximum_likelihood and not amplifier_limited"

#: Exit status of pytest where all tests passed.
PASSED = 0
#: Those that say that a mutant was noticed: a test failed, or the module cannot even be imported,
#: by a test file or by a `conftest.py`, which without the mutant they all could.
NOTICED = frozenset({1, 2, 4})


@dataclass
class Copy:
    """A copy of the tree in which one mutant at a time is tried."""

    root: Path

    @classmethod
    def of(cls, tree: Path, root: Path) -> Copy:
        """Copy a tree, with its compiled code: the sources keep the times that vouch for it."""
        shutil.copytree(tree, root, ignore=shutil.ignore_patterns(*_NOT_COPIED), symlinks=True)
        return cls(root)

    @contextmanager
    def mutated(self, mutant: Mutant) -> Iterator[tuple[str, str | None]]:
        """Hold a mutant in the copy; give the code before and after, None where none was made."""
        path = self.root / mutant.module
        source, stat = path.read_bytes(), path.stat()
        compiled = {one: one.read_bytes() for one in self._compiled(path)}
        try:
            operator = get_operator(f"core/{mutant.operator}")()
            yield apply_mutation(path, operator, mutant.occurrence)
        finally:
            path.write_bytes(source)
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
            for one in self._compiled(path):
                one.unlink()
            for one, content in compiled.items():
                one.write_bytes(content)

    @staticmethod
    def _compiled(path: Path) -> list[Path]:
        """Machine code that Numba keeps beside a module."""
        return [*(path.parent / "__pycache__").glob(f"{path.stem}.*.nb[ic]")]


@dataclass
class Run:
    """A forked process that runs tests in a copy."""

    process: int
    deadline: float
    started: float = field(default_factory=time.monotonic)
    _status: int | None = None

    def outcome(self) -> int | None:
        """Exit status of pytest, None while it runs; negative where it was killed."""
        if self._status is None:
            found, status = os.waitpid(self.process, os.WNOHANG)
            if found:
                self._status = os.waitstatus_to_exitcode(status)
            elif time.monotonic() > self.deadline:
                self.stop()
        return self._status

    def stop(self) -> None:
        """Kill the process and those it started."""
        if self._status is None:
            with suppress(ProcessLookupError):
                os.killpg(self.process, signal.SIGKILL)
            os.waitpid(self.process, 0)
            self._status = -signal.SIGKILL


def prepare() -> None:
    """Import what every run needs; one thread, as numbers must not depend on the machine."""
    for name in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
        os.environ[f"{name}_NUM_THREADS"] = "1"
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    os.environ.pop("NUMBA_CACHE_DIR", None)  # beside the source, in the copy: never the checkout's
    for name in _HEAVY:
        importlib.import_module(name)


def start(copy: Copy, tests: Sequence[str], output: Path, limit: float, *, clean: bool) -> Run:
    """Fork a process that runs tests in a copy, up to the first failure.

    Parameters
    ----------
    copy, tests
        Where, and which files.
    output
        Takes what pytest says; ``.seconds.json`` beside it the time of each file.
    limit
        Seconds.
    clean
        Whether the sources are as they were: only then is their bytecode kept.
    """
    sys.stdout.flush()
    process = os.fork()
    if process:
        return Run(process, time.monotonic() + limit)
    status = 70
    try:
        os.setsid()
        _enter(copy, output, clean=clean)
        status = _tested(tests, output)
    except BaseException:  # noqa: BLE001 - said, and then this process ends
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _enter(copy: Copy, output: Path, *, clean: bool) -> None:
    """Make this process one that knows the copy alone."""
    handle = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(handle, stream)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.chdir(copy.root)
    elsewhere = [one for one in sys.path if one and not _is_project(Path(one))]
    sys.path[:] = [str(copy.root), *elsewhere]
    importlib.invalidate_caches()
    for name in [one for one in sys.modules if one.split(".")[0] in {"tests", "tools"}]:
        del sys.modules[name]
    os.environ["PYTHONPATH"] = str(copy.root)
    os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(copy.root / ".hypothesis")
    if not clean:
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"


def _is_project(directory: Path) -> bool:
    """Say whether a directory of the search path holds a checkout, installed as editable."""
    return (directory / "registry").is_dir() and (directory / "pyproject.toml").is_file()


def _tested(tests: Sequence[str], output: Path) -> int:
    run = _TimedRun()
    plugins = ["-p", "_hypothesis_pytestplugin", "-p", "no:cacheprovider"]
    # of the project's own options only how tests are imported: others are of plugins left out
    own = ["-o", "addopts=--import-mode=importlib", "-W", "ignore::pytest.PytestConfigWarning"]
    options = ["-x", "-q", "--tb=short", "--hypothesis-seed=0", "-k", _QUICK]
    # pytest tidies the directory that all its runs share: two at a time would meet there
    apart = [f"--basetemp={output.with_suffix('.tmp')}"]
    status = int(pytest.main([*own, *plugins, *options, *apart, *tests], plugins=[run]))
    output.with_suffix(".seconds.json").write_text(json.dumps(run.seconds))
    return status


class _TimedRun:
    """A plug-in that adds up the seconds of every test file, and lets Hypothesis stop early."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def pytest_configure(self) -> None:
        # after the tests' own profile; the first example that fails will do: to make it smaller
        # takes minutes
        phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
        hypothesis.settings.register_profile("mutants", phases=phases, database=None, deadline=None)
        hypothesis.settings.load_profile("mutants")

    def pytest_runtest_logreport(self, report: Any) -> None:
        file = report.nodeid.partition("::")[0]
        self.seconds[file] = self.seconds.get(file, 0.0) + report.duration


def baseline(copy: Copy, tests: Iterable[str], output: Path) -> dict[str, float]:
    """Run tests on the tree as it is; seconds of each file. RuntimeError unless all pass."""
    run = start(copy, sorted(set(tests)), output, 3600.0, clean=True)
    while (status := run.outcome()) is None:
        time.sleep(0.2)
    if status != PASSED:
        raise RuntimeError(f"the tests fail without any mutant (status {status}):\n{tail(output)}")
    seconds: dict[str, float] = json.loads(output.with_suffix(".seconds.json").read_text())
    return seconds


def limit_of(tests: Iterable[str], seconds: dict[str, float]) -> float:
    """Seconds after which tests on a mutant count as hanging."""
    return _SPARE + 2.0 * sum(seconds.get(file, 0.0) for file in tests)


def tail(output: Path, lines: int = 25) -> str:
    """Return the end of what pytest said."""
    return "\n".join(output.read_text(errors="replace").splitlines()[-lines:])
