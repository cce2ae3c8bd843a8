"""Pairs of writers at once: afterwards both are there, or one was refused in a sentence."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from tools.faults.kills.children import contents, fresh, run, start
from tools.faults.kills.commands import (
    COMMANDS,
    budget_errors,
    export,
    measure_claims,
    pin,
    run_cells,
    sunatlas,
)

Act = Callable[[], object]

_THEIRS = COMMANDS["import"].act


def _others() -> None:
    sunatlas("survey", "import", "others.csv", "--apply", "--data", "tables")


#: What -> the command whose place they start from, and the two.
PAIRS: Mapping[str, tuple[str, Act, Act]] = {
    "two imports": ("import", _THEIRS, _others),
    "import and bibliography": ("import", _THEIRS, COMMANDS["bibliography"].act),
    "two exports to one place": ("export", lambda: export(6), lambda: export(7)),
    "two bundles to one place": ("deposit", COMMANDS["deposit"].act, COMMANDS["deposit"].act),
    "pins of two data sets": ("pin", lambda: pin("fake-diodes"), lambda: pin("fake-second")),
    "two runs in one store": (
        "run",
        lambda: run_cells("fake-diodes"),
        lambda: run_cells("fake-second"),
    ),
    "leaderboard and pins": ("update", COMMANDS["update"].act, lambda: pin("fake-second")),
    "claims": ("claims", lambda: measure_claims("C01", "C02"), lambda: measure_claims("C03")),
    "error budgets": (
        "error_budget",
        lambda: budget_errors("set-0"),
        lambda: budget_errors("set-1"),
    ),
}
_VARYING = ("durations.csv", "times.csv", "times_machine.json")


@dataclass(frozen=True)
class PairResult:
    """What came of a pair: how many were refused, and what is not as wanted."""

    what: str
    refused: int
    wrong: tuple[str, ...]


def meet(what: str, work: Path, draw: random.Random) -> PairResult:
    """Start two writers at once, call again who was refused, and compare with one after another."""
    name, *both = PAIRS[what]
    template = work / "template" / "place"
    template.mkdir(parents=True)
    run(COMMANDS[name].prepare, template)
    either = []
    for order in (both, both[::-1]):
        place = fresh(template, work / "one after another")
        codes = [run(act, place)[0] for act in order]
        if any(codes):
            said = (place.parent / "said.txt").read_text()
            raise RuntimeError(f"{what}: alone they end with {codes}: {said}")
        either.append(_made(place))
    place = fresh(template, work / "at once")
    children = []
    for act in both:
        children.append(start(act, place))
        time.sleep(draw.uniform(0.0, 0.1))
    codes = [child.wait() for child in children]
    said = children[0].said()
    refused = [act for act, code in zip(both, codes, strict=True) if code == 1]
    wrong = []
    if any(code not in (0, 1) for code in codes) or (refused and "is writing to" not in said):
        wrong.append(f"they ended with {codes}: {said}")
    again = [run(act, place)[0] for act in refused]
    wrong += [f"called again it ended with {code}" for code in again if code]
    if _made(place) not in either:
        wrong.append("what is there is not what one after the other makes")
    return PairResult(what, len(refused), tuple(wrong))


def _made(place: Path) -> dict[str, bytes | None]:
    time.sleep(0.3)
    return contents(place, _VARYING)
