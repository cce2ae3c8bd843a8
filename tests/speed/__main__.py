"""Every limit that is measured, one harness after another: ``python -m tests.speed``.

Each harness prints what it measures as it goes. None hides another: at the end stand all limits
that broke, and the harnesses that did not come to their end, and the exit status is 1 for any.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

from tests.speed.verdicts import Verdict

#: Modules of this package, each with `run() -> list[Verdict]`, imported when their turn comes: what
#: one cannot import is no reason to leave out the next.
NAMES = ("simulator", "extractors", "recommendations", "startup", "service")

Harness = Callable[[], Sequence[Verdict]]


def harnesses() -> dict[str, Harness]:
    """Return the harnesses by name, in their order; nothing is imported yet."""

    def harness(name: str) -> Harness:
        return lambda: import_module(f"tests.speed.{name}").run()

    return {name: harness(name) for name in NAMES}


def bench(found: Mapping[str, Harness]) -> int:
    """Run every harness to its end and list what broke; the exit status."""
    kept = 0
    complaints: list[str] = []
    for name, run in found.items():
        print(f"==== {name}\n", flush=True)
        try:
            verdicts = run()
        except Exception as error:  # noqa: BLE001 - whatever it is, the others have their turn
            traceback.print_exc(file=sys.stdout)
            said = f"{type(error).__name__}: {error}".partition("\n")[0]
            complaints.append(f"{name}: did not come to its end ({said})")
        else:
            kept += sum(verdict.holds for verdict in verdicts)
            complaints += [f"{name}: {_line(verdict)}" for verdict in verdicts if verdict.breaks]
            if not verdicts:
                complaints.append(f"{name}: judged nothing")
        print(flush=True)
    print("==== limits\n")
    print(f"{kept} kept, {len(complaints)} broken{':' if complaints else ''}")
    for complaint in complaints:
        print(f"  BROKEN {complaint}")
    return 1 if complaints else 0


def _line(verdict: Verdict) -> str:
    return f"{verdict.what}: {verdict.value:.4g}, limit {verdict.most:.4g}"


if __name__ == "__main__":
    sys.exit(bench(harnesses()))
