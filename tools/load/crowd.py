"""Many clients at once, each asking again as soon as it has its answer."""

from __future__ import annotations

import asyncio
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Crowd:
    """What many clients met.

    Attributes
    ----------
    answers : how many came
    errors : answers that are none of 200, and connections that broke
    median_ms, p99_ms : times to answer
    memory_mb : resident memory of the server after the first third of the time, and at the end;
        NaN where the system does not tell
    """

    answers: int
    errors: int
    median_ms: float
    p99_ms: float
    memory_mb: tuple[float, float]


def crowd(
    place: tuple[str, int], paths: Sequence[str], clients: int, seconds: float, process: int
) -> Crowd:
    """Send clients for some seconds; each walks the paths from a place of its own."""
    return asyncio.run(_crowd(place, paths, clients, seconds, process))


async def _crowd(
    place: tuple[str, int], paths: Sequence[str], clients: int, seconds: float, process: int
) -> Crowd:
    requests = [
        f"GET {path} HTTP/1.1\r\nHost: atlas\r\nAccept-Encoding: gzip\r\n\r\n".encode()
        for path in paths
    ]
    times: list[float] = []
    errors = 0
    end = time.monotonic() + seconds

    async def client(number: int) -> None:
        nonlocal errors
        turn = number
        while time.monotonic() < end:
            try:
                reader, writer = await asyncio.open_connection(*place)
                while time.monotonic() < end:
                    start = time.perf_counter()
                    writer.write(requests[turn % len(requests)])
                    turn += 1
                    head = await reader.readuntil(b"\r\n\r\n")
                    length = int(head.lower().partition(b"content-length:")[2].split(b"\r", 1)[0])
                    await reader.readexactly(length)
                    times.append(time.perf_counter() - start)
                    errors += not head.startswith(b"HTTP/1.1 200 ")
                writer.close()
            except (OSError, asyncio.IncompleteReadError, ValueError):
                errors += 1
                await asyncio.sleep(0.1)

    async def watch() -> tuple[float, float]:
        await asyncio.sleep(seconds / 3)
        early = memory_mb(process)
        await asyncio.sleep(max(0.0, end - time.monotonic() - 0.2))
        return early, memory_mb(process)

    memory, *_ = await asyncio.gather(watch(), *(client(number) for number in range(clients)))
    times.sort()
    return Crowd(
        len(times),
        errors,
        1e3 * statistics.median(times),
        1e3 * times[int(0.99 * len(times))],
        memory,
    )


def memory_mb(process: int) -> float:
    """Return the resident memory of a process, megabytes; NaN where there is no /proc."""
    place = Path(f"/proc/{process}/status")
    if not place.exists():
        return float("nan")
    line = next(line for line in place.read_text().splitlines() if line.startswith("VmRSS:"))
    return int(line.split()[1]) / 1024
