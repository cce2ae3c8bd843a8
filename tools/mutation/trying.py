"""The sample tried mutant by mutant, some at a time, with what was found kept as it comes."""

from __future__ import annotations

import ast
import difflib
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from cosmic_ray.work_db import WorkDB
from cosmic_ray.work_item import (
    MutationSpec,
    TestOutcome,
    WorkerOutcome,
    WorkItem,
    WorkResult,
)

from tools.mutation import running
from tools.mutation.groups import GROUPS
from tools.mutation.report import MutantResult
from tools.mutation.sample import Mutant


def try_all(
    tree: Path,
    sample: Mapping[str, Sequence[Mutant]],
    directory: Path,
    workers: int,
    database: WorkDB,
) -> list[MutantResult]:
    """Try mutants by group; RuntimeError where the tests fail without any.

    Parameters
    ----------
    tree
        The checkout: read, never written.
    sample
        Group -> mutants.
    directory
        For the copies in which they are tried.
    workers
        Mutants tried at a time.
    database
        Takes the results; those it says were caught are not tried again.
    """
    caught = {
        item.job_id: result.diff or ""
        for item, result in database.completed_work_items
        if result.test_outcome is TestOutcome.KILLED
    }
    known = {item.job_id for item in database.work_items}
    all_of_them = [(name, one) for name, found in sample.items() for one in found]
    database.add_work_items(_item(one) for _, one in all_of_them if one.key not in known)
    tried = [
        MutantResult(name, one, True, caught[one.key], 0.0)
        for name, one in all_of_them
        if one.key in caught
    ]
    waiting = deque((name, one) for name, one in all_of_them if one.key not in caught)
    if waiting:
        slots, seconds = _prepared(tree, list(waiting), directory, workers)
        total = len(waiting)
        for done, found in enumerate(_results(waiting, slots, seconds), start=1):
            database.set_result(found.mutant.key, _result(found))
            tried.append(found)
            said = "caught" if found.caught else "LIVES "
            place = f"{found.mutant.module}:{found.mutant.start[0]}"
            print(f"[{done}/{total}] {said} {found.seconds:5.1f} s  {place}", flush=True)
    return [one for one in tried if one.diff]  # the same program is no mutant


def _prepared(
    tree: Path, waiting: Sequence[tuple[str, Mutant]], directory: Path, workers: int
) -> tuple[list[_Slot], dict[str, float]]:
    """Copies of the tree whose tests pass, compiled, and the seconds of each test file."""
    first = running.Copy.of(tree, directory / "copy-0")
    files = {file for name, one in waiting for file in GROUPS[name].tests_of(one.module)}
    seconds = running.baseline(first, files, directory / "baseline.txt")
    print(f"{len(waiting)} mutants; the tests take {sum(seconds.values()):.0f} s without any")
    others = [
        running.Copy.of(first.root, directory / f"copy-{number}") for number in range(1, workers)
    ]
    return [_Slot(copy) for copy in (first, *others)], seconds


def _results(
    waiting: deque[tuple[str, Mutant]], slots: Sequence[_Slot], seconds: dict[str, float]
) -> Iterator[MutantResult]:
    try:
        while waiting or any(slot.busy for slot in slots):
            for slot in slots:
                found = slot.poll()
                if waiting and not slot.busy:
                    slot.begin(*waiting.popleft(), seconds)
                if found is not None:
                    yield found
            time.sleep(0.05)
    finally:
        for slot in slots:
            slot.end()


class _Slot:
    """One copy of the tree and the mutant that is tried in it."""

    def __init__(self, copy: running.Copy) -> None:
        self.copy = copy
        self.busy = False
        self._output = copy.root.with_suffix(".txt")
        self._held = ExitStack()

    def begin(self, group: str, mutant: Mutant, seconds: dict[str, float]) -> None:
        """Start the tests of a mutant."""
        tests = GROUPS[group].tests_of(mutant.module)
        before, after = self._held.enter_context(self.copy.mutated(mutant))
        self._group, self._mutant = group, mutant
        self._diff = _difference(before, after)
        limit = running.limit_of(tests, seconds)
        self._run = running.start(self.copy, tests, self._output, limit, clean=False)
        self.busy = True

    def poll(self) -> MutantResult | None:
        """Return what came of the mutant; None while it is tried, or where there is none."""
        status = self._run.outcome() if self.busy else None
        if status is None:
            return None
        taken = time.monotonic() - self._run.started
        self.end()
        if status > running.PASSED and status not in running.NOTICED:
            raise RuntimeError(f"pytest ended with {status}:\n{running.tail(self._output)}")
        caught = status != running.PASSED
        return MutantResult(self._group, self._mutant, caught, self._diff, taken)

    def end(self) -> None:
        """Put the sources back; whatever still runs is stopped."""
        if self.busy:
            self._run.stop()
        self._held.close()
        self.busy = False


def _difference(before: str, after: str | None) -> str:
    """Lines that a mutant changes; empty where it is the same program, or none."""
    try:
        if after is None or ast.dump(ast.parse(before)) == ast.dump(ast.parse(after)):
            return ""
    except SyntaxError:
        return ""
    changes = list(difflib.unified_diff(before.splitlines(), after.splitlines(), n=0))[2:]
    changed = [line for line in changes if not line.startswith("@@")]
    return "\n".join(f"{line[0]}{line[1:].strip()}" for line in changed)


def _item(mutant: Mutant) -> WorkItem:
    spec = MutationSpec(
        module_path=Path(mutant.module),
        operator_name=f"core/{mutant.operator}",
        occurrence=mutant.occurrence,
        start_pos=mutant.start,
        end_pos=mutant.end,
        definition_name=mutant.definition,
    )
    return WorkItem.single(mutant.key, spec)


def _result(tried: MutantResult) -> WorkResult:
    return WorkResult(
        worker_outcome=WorkerOutcome.NORMAL,
        output=f"{tried.seconds:.1f} s",
        test_outcome=TestOutcome.KILLED if tried.caught else TestOutcome.SURVIVED,
        diff=tried.diff,
    )
