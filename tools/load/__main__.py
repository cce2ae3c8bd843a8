"""`python -m tools.load`: what no test has the time for, against servers in processes of their own.

1. Requests put together at random, raw bytes among them: none is answered by a 5xx.
2. Schemathesis, from the OpenAPI document: no 5xx.
3. Many clients at once: no error, memory that stays, and a median time at most `MOST_TIMES` that of
   an empty FastAPI endpoint under the same load.
4. The same clients beside some that ask and never read: no error, and each of those is closed
   within `MOST_UNREAD_S`.

Exit status 1 where one of them does not hold. The seed is printed first, and repeats the requests.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import secrets
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import urlsplit

from api.http.openapi_sharing import inlined
from tools.load.crowd import Crowd, crowd
from tools.load.fuzzing import fuzz
from tools.load.unread import unread

MOST_TIMES = 1.5
UNREAD, MOST_UNREAD_S = 60, 30.0
#: Memory may grow by this share and these megabytes while the crowd is there: pages of the heap
#: are given back when they like.
MOST_GROWTH, MOST_GROWTH_MB = 0.02, 4.0
ROOT = Path(__file__).resolve().parents[2]
SERVICE = ("-m", "api.cli.command_line", "serve", "--port", "0")
EMPTY = ("-m", "tools.load.empty")
#: What pages and notebooks ask most.
COMMON = (
    "/v1/recommendations?task=Accuracy",
    "/v1/taxonomy",
    "/v1/studies?limit=20",
    "/v1/studies/Liebe2001",
    "/v1/datasets/cmos-single-aperture",
    "/v1/leaderboard/architectures?limit=20",
    "/v1/leaderboard/qpd-single-aperture?limit=20",
    "/v1/search?q=centroid",
    "/v1/algorithms?limit=20",
    "/v1/claims/C04",
)


@contextlib.contextmanager
def running(arguments: Sequence[str]) -> Iterator[tuple[tuple[str, int], int]]:
    """Run a server that prints where it answers; yield host with port, and its process id."""
    process = subprocess.Popen(
        [sys.executable, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        address = next(word for word in process.stdout.readline().split() if "://" in word)
        parts = urlsplit(address)
        with urllib.request.urlopen(f"{address}/", timeout=600):
            pass
        yield (str(parts.hostname), int(parts.port or 80)), process.pid
    finally:
        process.terminate()
        process.wait()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaigns; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.load")
    parser.add_argument("--requests", type=int, default=5000)
    parser.add_argument("--examples", type=int, default=50, help="of Schemathesis, an operation")
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=None)
    given = parser.parse_args(arguments)
    seed = secrets.randbelow(10**6) if given.seed is None else given.seed
    print(f"seed {seed}", flush=True)
    broken = []
    with running(SERVICE) as (place, _):
        url = f"http://{place[0]}:{place[1]}"
        with urllib.request.urlopen(f"{url}/openapi.json", timeout=600) as answer:
            paths = inlined(json.load(answer))
        try:
            found = fuzz(place, paths, given.requests, seed)
            print(f"fuzzed: {given.requests} requests, {dict(sorted(found.items()))}", flush=True)
        except AssertionError as error:
            broken.append(f"fuzzed: {error}")
        if given.examples and not _schemathesis(f"{url}/openapi.json", given.examples, seed):
            broken.append("schemathesis found an error, see above")
    with running(EMPTY) as (place, process):
        empty = crowd(place, ("/",), given.clients, given.seconds / 3, process)
    _print("empty endpoint", empty)
    with running(SERVICE) as (place, process):
        crowd(place, COMMON, 10, 2.0, process)  # answers are kept once they have been given
        met = crowd(place, COMMON, given.clients, given.seconds, process)
        _print("service", met)
        time.sleep(2.0)  # until the last of these clients has left
        with unread(place, UNREAD) as ignored:
            beside = crowd(place, COMMON, given.clients, max(given.seconds, MOST_UNREAD_S), process)
    _print(f"service beside {UNREAD} that never read", beside)
    last = max(ignored.closed_s, default=0.0)
    print(f"of these {len(ignored.closed_s)} were closed, the last after {last:.0f} s")
    if len(ignored.closed_s) < UNREAD or last > MOST_UNREAD_S:
        broken.append(f"not all that never read were closed within {MOST_UNREAD_S:g} s")
    if beside.errors:
        broken.append(f"{beside.errors} errors beside clients that never read")
    ratio = met.median_ms / empty.median_ms
    print(f"median over an empty endpoint's: {ratio:.2f}, at most {MOST_TIMES:g}")
    early, late = met.memory_mb
    if met.errors or empty.errors:
        broken.append(f"{met.errors} errors of the service, {empty.errors} of the empty endpoint")
    if ratio > MOST_TIMES:
        broken.append(f"median {ratio:.2f} times an empty endpoint's, at most {MOST_TIMES:g}")
    if late > early * (1 + MOST_GROWTH) + MOST_GROWTH_MB:
        broken.append(f"memory grew from {early:.0f} to {late:.0f} MB")
    for complaint in broken:
        print(f"BROKEN {complaint}")
    return 1 if broken else 0


def _schemathesis(url: str, examples: int, seed: int) -> bool:
    command = [
        *(str(Path(sys.executable).with_name("schemathesis")), "run", url),
        *("--checks", "not_a_server_error", "--max-examples", str(examples)),
        *("--seed", str(seed), "--no-color", "--phases", "examples,coverage,fuzzing"),
        *("--request-timeout", "600"),  # a picture is drawn when it is first asked for
    ]
    with tempfile.TemporaryDirectory() as own:  # it keeps what it found where it stands
        done = subprocess.run(command, cwd=own, capture_output=True, text=True, check=False)
    print("\n".join(done.stdout.splitlines()[-30:]), flush=True)
    return done.returncode == 0


def _print(what: str, met: Crowd) -> None:
    early, late = met.memory_mb
    print(
        f"{what}: {met.answers} answers, {met.errors} errors, median {met.median_ms:.1f} ms, "
        f"99 % within {met.p99_ms:.1f} ms, memory {early:.0f} to {late:.0f} MB",
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
