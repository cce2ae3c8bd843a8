"""What the tests saw and what they did not, beside the survivors that are known and why."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tools.mutation.sample import Mutant

#: Share of the mutants that the tests must see.
CAUGHT = 0.85

SURVIVORS = Path(__file__).with_name("survivors.toml")

Change = tuple[str, str, str]  # (module, lines before and after as a difference, definition)


@dataclass(frozen=True)
class MutantResult:
    """A mutant, and whether a test failed on it or hung."""

    group: str
    mutant: Mutant
    caught: bool
    diff: str
    seconds: float

    @property
    def change(self) -> Change:
        """What it is known by among the accepted survivors."""
        return (self.mutant.module, self.diff, self.mutant.definition)


def accepted_changes(path: Path = SURVIVORS) -> dict[Change, str]:
    """Read the known survivors: why each may live, by what it changes where."""
    listed = tomllib.loads(path.read_text())["survivor"] if path.is_file() else []
    return {
        (one["module"], one["change"].strip(), one["definition"]): one["reason"] for one in listed
    }


def score(tried: Iterable[MutantResult]) -> float:
    """Return the share that was caught."""
    found = [one.caught for one in tried]
    return sum(found) / len(found) if found else 0.0


def report(tried: Sequence[MutantResult], known: Mapping[Change, str]) -> str:
    """Write a Markdown report: scores of each group, then the survivors."""
    lines = [
        "# Mutants",
        "",
        "| Group | Mutants | Caught | Share | Live with a reason | Share without those |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    groups = sorted({one.group for one in tried})
    lines += [_row(name, [one for one in tried if one.group == name], known) for name in groups]
    if len(groups) > 1:
        lines.append(_row("**all**", tried, known))
    living = sorted(
        (one for one in tried if not one.caught),
        key=lambda one: (one.change in known, one.mutant.module, one.mutant.start),
    )
    for title, with_reason in (("without a reason", False), ("that may live", True)):
        listed = [one for one in living if (one.change in known) is with_reason]
        if listed:
            lines += ["", f"## Survivors {title}", ""]
        for one in listed:
            where = f"{one.mutant.module}:{one.mutant.start[0]}"
            lines += [f"`{where}` in `{one.mutant.definition or 'the module'}`", ""]
            lines += ["```diff", *one.diff.splitlines(), "```", ""]
            lines += [f"{known[one.change]}", ""] if with_reason else []
    return "\n".join(lines).rstrip() + "\n"


def _row(name: str, tried: Sequence[MutantResult], known: Mapping[Change, str]) -> str:
    caught = sum(one.caught for one in tried)
    excused = sum(not one.caught and one.change in known for one in tried)
    apart = caught / (len(tried) - excused) if len(tried) > excused else 1.0
    return (
        f"| {name} | {len(tried)} | {caught} | {caught / len(tried):.1%} | {excused} "
        f"| {apart:.1%} |"
    )
