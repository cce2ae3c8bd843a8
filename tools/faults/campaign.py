"""Trying damaged files, each in a process of its own: forked, so that imports are paid once."""

from __future__ import annotations

import json
import os
import random
import resource
import shutil
import signal
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.cli.command_line import is_known
from tools.faults.damage import damage
from tools.faults.kind import SAME, Kind

#: Of the processor: how busy the machine is otherwise is no fault of a file.
SECONDS = 10
#: After which a process that waits for something is ended, too.
PATIENCE_S = 90
MEGABYTES = 500

REFUSED, HARMLESS, WRONG, TRACEBACK, SLOW, LARGE = (
    "refused",
    "harmless",
    "accepted wrongly",
    "traceback",
    f"over {SECONDS} s",
    f"over {MEGABYTES} MB",
)
#: In the place of a file's name, where several were changed together.
FORGED = "forged"
OUTCOMES = (REFUSED, HARMLESS, WRONG, TRACEBACK, SLOW, LARGE)
FAULTS = (WRONG, TRACEBACK, SLOW, LARGE)


@dataclass(frozen=True)
class Case:
    """One damaged file and what became of it."""

    kind: str
    number: int
    file: str
    how: str
    outcome: str
    said: str
    seconds: float
    megabytes: float


def cases(kind: Kind, count: int, seed: int, scratch: Path) -> Iterator[Case]:
    """Try so many damaged files of a kind; the same ones for a seed."""
    sound = scratch / "sound"
    sound.mkdir(parents=True)
    names = [path.relative_to(sound) for path in kind.make(sound)]
    reference = kind.read(sound)
    for number in range(count):
        rng = random.Random(f"{seed} {kind.name} {number}")
        folder = scratch / "damaged"
        shutil.copytree(sound, folder)
        name = rng.choice(names)
        how = kind.forge(rng, folder) if kind.forge else damage(rng, folder / name)
        outcome, said, seconds, megabytes = _tried(kind, folder, reference)
        said = said.replace(str(folder), "").strip("/")
        file = FORGED if kind.forge else str(name)
        yield Case(kind.name, number, file, how, outcome, said, seconds, megabytes)
        shutil.rmtree(folder)
    shutil.rmtree(sound)


def _tried(kind: Kind, folder: Path, reference: Any) -> tuple[str, str, float, float]:
    back, into = os.pipe()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    started = time.monotonic()
    child = os.fork()
    if child == 0:
        os.close(back)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.alarm(PATIENCE_S)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        result = json.dumps(_outcome(kind, folder, reference))
        os.write(into, result.encode()[:60_000])
        os._exit(0)
    os.close(into)
    with os.fdopen(back, "rb") as reader:
        said = reader.read()
    _, status, used = os.wait4(child, 0)
    seconds = time.monotonic() - started
    megabytes = max(used.ru_maxrss - before, 0) / 1024
    if os.WIFSIGNALED(status):
        killed = os.WTERMSIG(status)
        outcome = SLOW if killed in (signal.SIGALRM, signal.SIGPROF) else TRACEBACK
        return outcome, f"ended by signal {killed}", seconds, megabytes
    outcome, result = json.loads(said)
    if megabytes > MEGABYTES:
        outcome = LARGE
    return outcome, result, seconds, megabytes


def _outcome(kind: Kind, folder: Path, reference: Any) -> tuple[str, str]:
    try:
        result = kind.read(folder)
    except Exception as error:  # noqa: BLE001 - what it is decides
        if is_known(error) or type(error).__module__.startswith("tools."):
            return REFUSED, " ".join(str(error).split())[:300]
        return TRACEBACK, traceback.format_exc()[-1500:]
    if result == reference:
        return HARMLESS, SAME
    if kind.differing and kind.may(result, reference):
        return HARMLESS, kind.differing
    return WRONG, "another result, unsaid"
