"""Times of 100 honest clients while the service is attacked: `python FILE [SECONDS [NAME ...]]`.

The service runs with two workers. Each honest client keeps its connection and asks for one of some
pages a second, from an address of its own; who attacks is another process. Prints a line an attack.
"""

from __future__ import annotations

import asyncio
import io
import multiprocessing
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from statistics import quantiles
from typing import Any, NamedTuple
from urllib.request import urlopen

import openpyxl

ROOT = Path(__file__).resolve().parents[3]
PAGES = (
    *("/", "/v1/taxonomy", "/v1/studies?limit=20", "/v1/studies/Liebe2001", "/v1/claims/C04"),
    *("/v1/datasets/cmos-single-aperture", "/v1/leaderboard/architectures?limit=20"),
    *("/v1/leaderboard/qpd-single-aperture?limit=20", "/v1/search?q=centroid", "/v1/flows/error"),
)
#: Seconds from one question of a client to its next.
EVERY_S = 1.0
CAMERA = b"x_px,y_px,theta_x_deg,theta_y_deg\n" + b"".join(
    b"%d.%d,%d,%d,%d\n" % (512 + 6 * x, y % 9, 512 + 6 * y, x, y)
    for x in range(-45, 46)
    for y in range(-45, 46)
)


def posted(body: bytes, kind: bytes = b"multipart/form-data; boundary=a") -> bytes:
    head = (
        b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nContent-Type: %s\r\nContent-Length: %d\r\n"
    )
    return head % (kind, len(body)) + b"\r\n" + body


def form(name: bytes, data: bytes) -> bytes:
    part = (
        b'--a\r\nContent-Disposition: form-data; name="file"; filename="%s"\r\n\r\n%s\r\n--a--\r\n'
    )
    return posted(part % (name, data))


def far_cell() -> bytes:
    book: Any = openpyxl.Workbook()
    book.active["XFD1048576"] = 1
    packed = io.BytesIO()
    book.save(packed)
    return packed.getvalue()


class Attack(NamedTuple):
    """What so many senders send, so many bytes a step; then each listens, or hangs up."""

    senders: int
    sent: bytes
    step: int = 2**16
    pause_s: float = 0.0  # after each step
    hangs_up: bool = False
    again: bool = True
    apart: bool = False  # each has an address of its own


LARGE = form(b"a.csv", (CAMERA * 99)[:9_900_000])
CHUNKED = b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
ATTACKS = {
    "nothing": Attack(0, b""),
    "head-of-a-part": Attack(4, posted(b"--a\r\nContent-Disposition: a" + b";" * 300_000)),
    "content-type": Attack(4, posted(b"", b";" * 100_000)),
    "far-cells": Attack(50, form(b"a.xlsx", far_cell())),
    "large-files": Attack(400, LARGE, again=False, apart=True),
    "slow-uploads": Attack(100, LARGE, step=25_000, pause_s=0.5),
    "cut-uploads": Attack(20, LARGE[:2_000_000], hangs_up=True),
    "hanging-up": Attack(20, form(b"a.csv", CAMERA), pause_s=1.0, hangs_up=True),
    "calibrations": Attack(20, form(b"a.csv", CAMERA)),
    "tiny-chunks": Attack(20, CHUNKED + b"1\r\nx\r\n" * 50_000, step=6),
    "idle": Attack(450, b"G", pause_s=60),
    "reloads": Attack(0, b""),  # by the signal, every five seconds
}


async def status(reader: asyncio.StreamReader) -> int:
    """Read an answer to its end."""
    head = await reader.readuntil(b"\r\n\r\n")
    _, found, rest = head.lower().partition(b"content-length:")
    await reader.readexactly(int(rest.partition(b"\r\n")[0]) if found else 0)
    return int(head.split()[1])


async def send(port: int, source: str, attack: Attack, counts: Counter[str]) -> None:
    """Attack from an address, once or again and again."""
    while True:
        said = "hung up"
        try:
            plug = await asyncio.open_connection("127.0.0.1", port, local_addr=(source, 0))
            answer = asyncio.ensure_future(status(plug[0]))
            try:
                with suppress(OSError):  # what is answered says why
                    for at in range(0, len(attack.sent), attack.step):
                        plug[1].write(attack.sent[at : at + attack.step])
                        await plug[1].drain()
                        await asyncio.wait((answer,), timeout=attack.pause_s)
                if not attack.hangs_up:
                    said = str(await answer)
            finally:
                answer.cancel()
                plug[1].close()
        except (OSError, asyncio.IncompleteReadError) as error:
            said = type(error).__name__
        counts[said] += 1
        if not attack.again:
            return


async def attacked(port: int, attack: Attack, seconds: float) -> Counter[str]:
    """Return what the senders heard, and how many still waited at the end."""
    counts = Counter[str]()
    sources = [f"127.2.{n // 250}.{n % 250 + 1}" for n in range(attack.senders)]
    if not attack.apart:
        sources = ["127.3.3.3"] * attack.senders
    tasks = [asyncio.create_task(send(port, one, attack, counts)) for one in sources]
    if attack.again:
        tasks.append(asyncio.create_task(asyncio.sleep(seconds)))
    waiting = (await asyncio.wait(tasks, timeout=seconds if attack.again else 600))[1]
    counts["still there"] = len(waiting)
    return +counts


async def read(port: int, number: int, over: asyncio.Event, seen: list[tuple[float, int]]) -> None:
    """Ask for pages; status 0 where the connection ends before the answer."""
    rng = random.Random(number)
    await asyncio.sleep(EVERY_S * rng.random())
    plug = None
    while not over.is_set():
        source = (f"127.1.1.{number + 1}", 0)
        plug = plug or await asyncio.open_connection("127.0.0.1", port, local_addr=source)
        asked, answer = time.monotonic(), 0
        plug[1].write(f"GET {rng.choice(PAGES)} HTTP/1.1\r\nHost: a\r\n\r\n".encode())
        with suppress(OSError, asyncio.IncompleteReadError):
            answer = await status(plug[0])
        seen.append((time.monotonic() - asked, answer))
        if not answer:
            plug[1].close()
            plug = None
        await asyncio.sleep(max(0.0, asked + EVERY_S - time.monotonic()))


async def meanwhile(port: int, attacker: Any, server: int | None) -> list[tuple[float, int]]:
    """Return seconds and status of every answer that honest clients get while another attacks."""
    seen: list[tuple[float, int]] = []
    over = asyncio.Event()
    readers = [asyncio.create_task(read(port, n, over, seen)) for n in range(100)]
    for second in range(10**6):
        if not attacker.is_alive():
            break
        if server and second % 5 == 2:
            os.kill(server, signal.SIGHUP)
        await asyncio.sleep(1)
    over.set()
    await asyncio.gather(*readers)
    return seen


def _attack(port: int, name: str, seconds: float) -> None:
    os.nice(10)
    said = asyncio.run(attacked(port, ATTACKS[name], seconds))
    sys.stdout.write(f"  {name}: senders heard {dict(said)}\n")
    sys.stdout.flush()


@contextmanager
def service() -> Iterator[tuple[int, int]]:
    """Port and process of the service, whose two workers are ready."""
    command = [sys.executable, "-m", "api.cli.command_line", "serve", "--port", "0"]
    with subprocess.Popen(
        [*command, "--workers", "2"], cwd=ROOT, stdout=subprocess.PIPE, start_new_session=True
    ) as process:
        try:
            assert process.stdout is not None
            url, begun = process.stdout.readline().split()[3].decode(), time.monotonic()
            urlopen(f"{url}/healthz", timeout=600).close()
            time.sleep(time.monotonic() - begun)  # the other began with it
            yield int(url.rpartition(":")[2]), process.pid
        finally:
            process.terminate()


def main(seconds: float = 20, *names: str) -> None:
    with service() as (port, server):
        for name in names or ATTACKS:
            attacker = multiprocessing.get_context("fork").Process(
                target=_attack, args=(port, name, seconds)
            )
            attacker.start()
            seen = asyncio.run(meanwhile(port, attacker, server if name == "reloads" else None))
            times = quantiles((1e3 * took for took, _ in seen), n=20)
            bad = Counter(answer for _, answer in seen if answer != 200)
            sys.stdout.write(
                f"{name}: {len(seen)} answers, median {times[9]:.1f} ms, 95 % {times[-1]:.1f} ms; "
                f"not 200: {dict(bad) or 'none'}; load {os.getloadavg()[0]:.1f}\n"
            )
            sys.stdout.flush()


if __name__ == "__main__":
    main(float(sys.argv[1] if sys.argv[1:] else 20), *sys.argv[2:])
