"""The service and the command line: times of answers, sizes, and what idling and starting cost.

Questions are drawn by SEED. The limits on milliseconds are for the development machine.
"""

from __future__ import annotations

import contextlib
import os
import random
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from http.client import HTTPConnection
from itertools import islice
from pathlib import Path
from urllib.parse import urlencode, urlsplit

import psutil

from registry.ranking import SORTS
from registry.requirements import HAZARDS, MISSIONS
from registry.studies import facts

from .paired import at_most, ratio

ROOT = Path(__file__).parents[2]
PATH = "/v1/recommendations"
_SEED = int(os.environ.get("SEED") or 1)
_QUESTIONS, _WARM, _SHARE = 300, 20, 0.35
_IDLE_S = 30.0


@contextlib.contextmanager
def served() -> Iterator[tuple[HTTPConnection, psutil.Process]]:
    """Serve in a process of its own; give a connection to it, ready, and the process."""
    command = (sys.executable, "-m", "api.cli.command_line", "serve", "--port", "0")
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            words = process.stdout.readline().split()
            place = urlsplit(next(word for word in words if "://" in word))
            connection = HTTPConnection(str(place.hostname), place.port, timeout=600)
            ask(connection, "/healthz")  # waits until it is ready
            yield connection, psutil.Process(process.pid)
        finally:
            process.terminate()


def ask(connection: HTTPConnection, path: str) -> tuple[float, int]:
    """Return how long an answer takes, ms, and its bytes; RuntimeError where it is a refusal."""
    start = time.perf_counter()
    connection.request("GET", path)
    response = connection.getresponse()
    size = len(response.read())
    if response.status != 200:
        raise RuntimeError(f"{path} was answered by {response.status}")
    return 1e3 * (time.perf_counter() - start), size


def questions(seed: int) -> Iterator[str]:
    """Give addresses of requirements drawn at random, whether anything meets them or not."""
    values, rng = facts().taxonomy.values, random.Random(seed)
    numbers: dict[str, Callable[[], float]] = {
        "max_error_deg": lambda: 10.0 ** rng.uniform(-3.5, 1.0),
        "min_fov_deg": lambda: rng.uniform(5.0, 200.0),
        "bench_deg": lambda: 10.0 ** rng.uniform(-3.0, -1.0),
        "max_mass_g": lambda: 10.0 ** rng.uniform(0.5, 3.0),
        "max_latency_us": lambda: 10.0 ** rng.uniform(0.0, 4.0),
    }
    while True:
        asked: dict[str, object] = {"sort": rng.choice(SORTS)}
        asked |= {name: draw() for name, draw in numbers.items() if rng.random() < _SHARE}
        for name in ("task", "accuracy", "detector"):
            if rng.random() < _SHARE / 2:
                asked[name] = rng.choice(values(name))
        for name in ("detector", "mask", "model", "extractor", "error"):
            if rng.random() < _SHARE:
                asked[f"exclude_{name}"] = rng.choice(values(name))
        for name, among in (("tolerate", HAZARDS), ("mission", MISSIONS)):
            if rng.random() < _SHARE / 3:
                asked[name] = rng.choice(list(among))
        yield f"{PATH}?{urlencode(asked)}"


def measured() -> dict[str, float]:
    """Serve once, and measure all there is to measure of it."""
    drawn = questions(_SEED)
    with served() as (connection, process):
        for path in islice(drawn, _WARM):
            ask(connection, path)
        new = sorted(ask(connection, path)[0] for path in islice(drawn, _QUESTIONS))
        again = sorted(ask(connection, PATH)[0] for _ in range(_QUESTIONS))
        sizes = [ask(connection, path)[1] for path in (PATH, "/openapi.json")]
        time.sleep(5.0)
        before = process.cpu_times()
        time.sleep(_IDLE_S)
        after = process.cpu_times()
        one = not process.children(recursive=True)
    spent = after.user + after.system - before.user - before.system
    return {
        "new": new[int(0.95 * _QUESTIONS)],
        "again": again[int(0.95 * _QUESTIONS)],
        "answer": sizes[0],
        "openapi": sizes[1],
        "idle": spent * 60.0 / _IDLE_S if one else float("inf"),
    }


class Service:
    """Recommendations over HTTP; 95 of 100 answers take at most so long."""

    timeout = 600

    def setup_cache(self) -> dict[str, float]:
        return measured()

    def track_new_question_ms(self, found: dict[str, float]) -> float:
        return at_most(20.0, found["new"])

    def track_repeated_question_ms(self, found: dict[str, float]) -> float:
        return at_most(3.0, found["again"])

    def track_usual_answer_bytes(self, found: dict[str, float]) -> float:
        return at_most(30_000, found["answer"])

    def track_openapi_bytes(self, found: dict[str, float]) -> float:
        return at_most(200_000, found["openapi"])

    def track_idle_processor_s_a_minute(self, found: dict[str, float]) -> float:
        """While nobody asks; infinite where the service is more than one process."""
        return at_most(1.0, found["idle"])


def track_lines_of_registry_and_schema() -> float:
    """Lines of the code that answers."""
    files = [*(ROOT / "registry").rglob("*.py"), *(ROOT / "api" / "schema").rglob("*.py")]
    return at_most(9_318, sum(len(file.read_text("utf-8").splitlines()) for file in files))


def track_help_over_importing_typer() -> float:
    """Processor time of a process each."""

    def run(*arguments: str) -> Callable[[], object]:
        command = [sys.executable, *arguments]
        return lambda: subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, check=True)

    def spent() -> float:
        times = os.times()
        return times.children_user + times.children_system

    call = run("-m", "api.cli.command_line", "--help")
    return at_most(2.5, ratio(call, run("-c", "import typer"), repeats=5, clock=spent))
