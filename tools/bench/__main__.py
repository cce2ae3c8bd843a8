"""Every limit that is measured, one harness after another: ``python -m tools.bench [--seed N]``.

Frames of one harness are drawn afresh each time: the seed is printed first, and repeats them. Each
harness prints what it measures as it goes. None hides another: at the end stand all limits
that broke, and the harnesses that did not come to their end, and the exit status is 1 for any.
"""

from __future__ import annotations

import argparse
import secrets
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

from tools.bench.verdicts import Verdict

#: Modules of this package, each with `run() -> list[Verdict]`, imported when their turn comes: what
#: one cannot import is no reason to leave out the next.
NAMES = (
    "simulator",
    "extractors",
    "robustness",
    "covariances",
    "models",
    "startup",
    "service",
    "growth",
)
#: Those of them that draw what they measure on: `run(seed)`.
SEEDED = frozenset({"robustness", "covariances", "service"})

Harness = Callable[[], Sequence[Verdict]]


def harnesses(seed: int) -> dict[str, Harness]:
    """Return the harnesses by name, in their order; nothing is imported yet."""

    def harness(name: str) -> Harness:
        given = (seed,) if name in SEEDED else ()
        return lambda: import_module(f"tools.bench.{name}").run(*given)

    return {name: harness(name) for name in NAMES}


def new_seed() -> int:
    """Return a seed of six digits that nobody chose."""
    return secrets.randbelow(10**6)


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the seed and run everything; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench")
    parser.add_argument("--seed", type=int, help="of frames drawn afresh (default: a new one)")
    given = parser.parse_args(arguments).seed
    seed = new_seed() if given is None else given
    print(f"seed {seed}\n")
    return bench(harnesses(seed))


if __name__ == "__main__":
    sys.exit(main())
