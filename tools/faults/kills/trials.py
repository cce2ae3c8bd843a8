"""Kills: a program is killed at a moment drawn by seed, called again, and held against one that
was left alone.
"""

from __future__ import annotations

import random
import shutil
import signal
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from tools.faults.kills.children import SAID, TEMPORARY, contents, fresh, run, start
from tools.faults.kills.commands import COMMANDS, Command

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
#: Exit codes of a program that a signal ended; 0 where it had ended before.
_ENDED = {signal.SIGKILL: -9, signal.SIGTERM: 143, signal.SIGINT: 130}


@dataclass(frozen=True)
class Kill:
    """One kill.

    Attributes
    ----------
    command, signal, at_s
        What was killed by what, and when, seconds since its start.
    hit
        Whether it was killed before its end.
    left
        Whether it left anything that an undisturbed run does not.
    wrong
        What is not as wanted, one sentence each.
    """

    command: str
    signal: str
    at_s: float
    hit: bool
    left: bool
    wrong: tuple[str, ...]


@dataclass(frozen=True)
class UndisturbedRun:
    """What a program makes when it is left alone: where it starts, what is there then, how long."""

    template: Path
    made: Mapping[str, bytes | None]
    seconds: float


def run_undisturbed(name: str, work: Path) -> UndisturbedRun:
    """Prepare a program's place and run it twice, which must make the same bytes."""
    command = COMMANDS[name]
    template = work / name / "template" / "place"
    template.mkdir(parents=True)
    code, _ = run(command.prepare, template)
    if code:
        raise RuntimeError(f"{name} cannot be prepared: {code}")
    shutil.rmtree(template.parent / TEMPORARY)
    made = []
    for _ in range(2):
        place = fresh(template, work / name / "undisturbed")
        code, seconds = run(command.act, place)
        if code:
            said = (place.parent / SAID).read_text()
            raise RuntimeError(f"{name} ended with {code}: {said}")
        time.sleep(0.3)  # joblib's tracker of temporary files ends a moment later
        made.append(contents(place, command.varying))
    if made[0] != made[1]:
        raise RuntimeError(f"{name} does not make the same bytes twice: nothing to compare with")
    return UndisturbedRun(template, made[0], seconds)


def kills(number: int, seed: int, work: Path, names: list[str]) -> Iterator[Kill]:
    """Kill programs in turn, with every signal in turn, at random moments."""
    draw = random.Random(seed)
    known = {}
    for name in names:
        known[name] = run_undisturbed(name, work)
        sys.stderr.write(f"{name}: {known[name].seconds:.2f} s when it is left alone\n")
    for count in range(number):
        name = names[count % len(names)]
        by = SIGNALS[count // len(names) % len(SIGNALS)]
        yield kill_once(name, by, draw.uniform(0.0, 1.0), known[name], work / name / "killed")


def kill_once(
    name: str, by: signal.Signals, share: float, known: UndisturbedRun, work: Path
) -> Kill:
    """Kill a program after a share of its time, and call it again."""
    command = COMMANDS[name]
    place = fresh(known.template, work)
    child = start(command.act, place)
    at_s = share * known.seconds
    time.sleep(at_s)
    child.kill(by)
    wrong = []
    try:
        code = child.wait()
    except TimeoutError as error:
        code, wrong = 0, [f"after {by.name} {error}"]
    if code not in (0, _ENDED[by]):
        wrong.append(f"it ended with {code} after {by.name}: {child.said()}")
    if lasting := child.lasting():
        wrong.append(f"{len(lasting)} workers live on: {lasting[0]}")
    left = set(contents(place)) - set(known.made) != set()
    wrong += _again(command, known, place)
    return Kill(name, by.name, at_s, code != 0, left, tuple(wrong))


def _again(command: Command, known: UndisturbedRun, place: Path) -> list[str]:
    """Call a program again and say what is not as it is when left alone."""
    code, _ = run(command.act, place)
    if code:
        said = (place.parent / SAID).read_text(errors="replace")[-300:]
        return [f"called again it ended with {code}: {said}"]
    deadline = time.monotonic() + 2.0
    while (now := contents(place, command.varying)) != known.made and time.monotonic() < deadline:
        time.sleep(0.1)
    more, less = sorted(now.keys() - known.made.keys()), sorted(known.made.keys() - now.keys())
    other = sorted(n for n in now.keys() & known.made.keys() if now[n] != known.made[n])
    differences = {"left behind": more, "missing": less, "of other bytes": other}
    return [f"{len(them)} {what}: {them[0]}" for what, them in differences.items() if them]
