"""The campaign's tables, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from tools.faults.kills.commands import COMMANDS
from tools.faults.kills.pairs import PairResult
from tools.faults.kills.trials import SIGNALS, Kill


def report(kills: Sequence[Kill], met: Sequence[PairResult]) -> str:
    """Return what was killed, what met, and what was wrong of either."""
    hit, left = sum(kill.hit for kill in kills), sum(kill.left for kill in kills)
    columns = (*(by.name for by in SIGNALS), "before its end", "left files", "wrong")
    summary = (
        f"{len(kills)} kills; {hit} before the end of the program, {left} left files that the "
        f"next call had to remove. Wrong results: {sum(bool(kill.wrong) for kill in kills)}."
    )
    lines = [
        summary,
        "",
        f"| program | {' | '.join(columns)} |",
        f"| --- |{' ---: |' * len(columns)}",
    ]
    for name in dict.fromkeys(kill.command for kill in kills):
        some = [kill for kill in kills if kill.command == name]
        counts = [
            *(sum(kill.signal == by.name for kill in some) for by in SIGNALS),
            sum(kill.hit for kill in some),
            sum(kill.left for kill in some),
            sum(bool(kill.wrong) for kill in some),
        ]
        lines.append(f"| {COMMANDS[name].what} | {' | '.join(map(str, counts))} |")
    lines += ["", "| writers at once | refused | wrong |", "| --- | ---: | ---: |"]
    lines += [f"| {one.what} | {one.refused} of 2 | {len(one.wrong)} |" for one in met]
    return "\n".join(lines) + "\n"


def complaints(kills: Sequence[Kill], met: Sequence[PairResult]) -> list[str]:
    """Return what was not as wanted, a line each."""
    found = [
        f"{kill.command}, {kill.signal} after {kill.at_s:.2f} s: {said}"
        for kill in kills
        for said in kill.wrong
    ]
    return found + [f"{one.what}: {said}" for one in met for said in one.wrong]
