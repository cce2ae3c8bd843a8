"""The common test suite run on one algorithm, with what fails in plain words."""

from __future__ import annotations

import importlib.util
import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import algorithms
from algorithms import discovery
from algorithms.discovery import discover_compensations, discover_extractors, discover_models
from api.cli.wrong_call import WrongCallError
from benchmark.contract import UnknownNameError
from files.atomic import temporary_directory

ROOT = Path(algorithms.__file__).parents[1]
#: Where the checks are, in a checkout.
SUITE = ("test_common_suite.py", "test_docstrings.py", "test_measurement.py")
GUIDE = "docs/guide/add-an-algorithm.md"


@dataclass(frozen=True)
class ContractResult:
    """How many checks ran on an algorithm, and what failed, a line a check."""

    ran: int
    failures: tuple[str, ...]


def name_of(given: str) -> str:
    """Return the name of an algorithm that is given by its name or its file.

    Raises
    ------
    WrongCallError
        Where a module of `algorithms` cannot be imported or breaks the contract, and for a file
        that holds no algorithm or several.
    UnknownNameError
        For a name that discovery does not find, naming the nearest.
    """
    try:
        found = {**discover_extractors(), **discover_compensations(), **discover_models()}
    except Exception as error:
        raise WrongCallError(f"{_place(error)}{type(error).__name__}: {error}") from error
    if not given.endswith(".py"):
        if given not in found:
            raise UnknownNameError("algorithm", given, found)
        return given
    path = Path(given).resolve()
    if not path.is_file():
        raise WrongCallError(f"{given}: no such file")
    names = [name for name, cls in found.items() if Path(inspect.getfile(cls)).resolve() == path]
    if len(names) == 1:
        return names[0]
    if names:
        raise WrongCallError(f"{given} holds {', '.join(names)}; name one of them")
    raise WrongCallError(
        f"{given}: no public class with extract, transform or predict; an algorithm is one file in "
        f"algorithms/extractors/, compensations/ or models/ of {ROOT} ({GUIDE})"
    )


def check_contract(name: str) -> ContractResult | None:
    """Run the common suite on one algorithm; None where this is no checkout with its tests.

    Raises
    ------
    WrongCallError
        Where the test runner is not installed or found nothing to run.
    """
    suite = ROOT / "tests" / "algorithms"
    if not suite.is_dir():
        return None
    if importlib.util.find_spec("pytest") is None:
        raise WrongCallError("the checks of the contract need pytest: `make install`")
    with temporary_directory() as folder:
        report = folder / "report.xml"
        done = subprocess.run(  # noqa: S603 - our own tests
            [
                *(sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"),
                *("--import-mode=importlib", f"--junitxml={report}"),
                *(str(suite / file) for file in SUITE),
                *("-k", f"[{name}-check or [{name}]"),
            ],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode not in {0, 1}:
            raise WrongCallError(f"the checks did not run: {(done.stderr or done.stdout).strip()}")
        cases = list(ET.parse(report).iter("testcase"))  # noqa: S314 - written just now
    return ContractResult(len(cases), tuple(_failures(cases)))


def _failures(cases: list[ET.Element]) -> Iterator[str]:
    for case in cases:
        for kind in ("failure", "error"):
            fault = case.find(kind)
            if fault is not None:
                yield f"{_statement(case.get('name', ''))}: {_said(fault)}"


def _statement(test: str) -> str:
    """Return what a check states: its name in words."""
    function, _, parameters = test.partition("[")
    _, found, check = parameters.rstrip("]").partition("-check_")
    return (check if found else function.removeprefix("test_")).replace("_", " ")


def _said(fault: ET.Element) -> str:
    message = (fault.get("message") or "").strip()
    return re.sub(r"^\w*(Error|Exception): ", "", " ".join(message.split()))[:300]


def _place(error: Exception) -> str:
    """Name the file of the project in which an import failed, where one is known."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}, line {error.lineno}: "
    trace, place = error.__traceback__, ""
    while trace is not None:
        file = Path(trace.tb_frame.f_code.co_filename)
        if file.is_relative_to(ROOT / "algorithms") and file != Path(discovery.__file__):
            place = f"{file.relative_to(ROOT)}, line {trace.tb_lineno}: "
        trace = trace.tb_next
    return place
