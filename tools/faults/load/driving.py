"""Asking a service at a steady rate, and watching what it takes of the machine."""

from __future__ import annotations

import random
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx

from tools.faults.load.requests import Names, Request, drawn

#: Threads that ask: enough that one slow answer does not hold up the rest.
_ASKING = 16
_MEMORY_EVERY_S = 5.0


@dataclass(frozen=True)
class Answer:
    """One answer: when it was asked (seconds since the start), how long it took, its status.

    ``late_s`` is how long after its time it was asked, where this machine was busy.
    """

    kind: str
    path: str
    at_s: float
    took_s: float
    late_s: float
    status: int


@dataclass
class Load:
    """What came of it: answers, and memory (seconds, bytes), of its own and resident.

    A process' own memory is what no file backs. Pages of files, its libraries among them, are
    resident as long as the system has room for them: they come and go without its doing.
    """

    rate: float
    seconds: float
    answers: list[Answer] = field(default_factory=list)
    memory: list[tuple[float, int]] = field(default_factory=list)
    resident: list[tuple[float, int]] = field(default_factory=list)


@contextmanager
def service() -> Iterator[tuple[str, int]]:
    """Serve in a process of its own; its address and number."""
    command = [sys.executable, "-m", "api.cli.command_line", "serve", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            found = re.search(r"http://\S+", line)
            if not found:
                raise RuntimeError(f"the service did not say where it answers; got {line!r}")
            yield found[0], process.pid
        finally:
            process.terminate()


def names(address: str) -> Names:
    """Ask a service what there is to ask about; each list once, which is its first answer too."""
    with httpx.Client(base_url=address, timeout=120) as client:

        def items(path: str) -> list[dict[str, Any]]:
            found: list[dict[str, Any]] = client.get(path).raise_for_status().json()["items"]
            return found

        page = client.get("/").raise_for_status().text
        datasets = items("/v1/datasets")
        assets = re.findall(r'(?:src|href)="(/?[\w./-]+\.(?:js|css|svg))"', page)
        return Names(
            studies=tuple(item["key"] for item in items("/v1/studies?limit=200")),
            datasets=tuple(item["name"] for item in datasets),
            claims=tuple(item["id"] for item in items("/v1/claims")),
            detectors=tuple(sorted({item["detector"] for item in datasets})),
            masks=tuple(sorted({item["mask"] for item in datasets})),
            assets=("/", *(f"/{name.lstrip('/')}" for name in assets)),
        )


def load(
    address: str, process: int, known: Names, *, rate: float, seconds: float, seed: int
) -> Load:
    """Ask at a steady rate: each request has its time, whatever became of those before it."""
    found = Load(rate, seconds)
    draw = random.Random(seed)
    planned = [drawn(draw, known) for _ in range(int(rate * seconds))]
    start, lock, ended = time.monotonic() + 0.5, threading.Lock(), threading.Event()
    numbers = iter(range(len(planned)))

    def ask() -> None:
        connection = _connected(address)
        while True:
            with lock:
                number = next(numbers, None)
            if number is None:
                connection.close()
                return
            due = start + number / rate
            time.sleep(max(0.0, due - time.monotonic()))
            began = time.monotonic()
            status = _status(connection, planned[number])
            took = time.monotonic() - began
            one = planned[number]
            found.answers.append(
                Answer(one.kind, one.path, began - start, took, began - due, status)
            )

    def watch() -> None:
        while not ended.wait(_MEMORY_EVERY_S):
            at, (own, resident) = time.monotonic() - start, memory(process)
            found.memory.append((at, own))
            found.resident.append((at, resident))

    threads = [threading.Thread(target=ask) for _ in range(_ASKING)]
    watching = threading.Thread(target=watch)
    for thread in (watching, *threads):
        thread.start()
    for thread in threads:
        thread.join()
    ended.set()
    watching.join()
    return found


def memory(process: int) -> tuple[int, int]:
    """Return a process' own and its resident memory, bytes."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    kilobytes = {line.split(":")[0]: int(line.split()[1]) for line in lines if line.endswith(" kB")}
    if "VmRSS" not in kilobytes:
        raise RuntimeError(f"process {process} has ended")
    own = kilobytes["RssAnon"] + kilobytes["RssShmem"]
    return own * 1024, kilobytes["VmRSS"] * 1024


def _connected(address: str) -> HTTPConnection:
    parts = urlsplit(address)
    return HTTPConnection(str(parts.hostname), parts.port, timeout=120)


def _status(connection: HTTPConnection, request: Request) -> int:
    """Ask and read the whole answer; 0 where there was none."""
    try:
        connection.request(request.method, request.path, request.body, dict(request.headers))
        response = connection.getresponse()
        response.read()
    except (OSError, HTTPException):
        connection.close()  # opened again by the next request
        return 0
    return response.status
