"""`make bench` runs every harness to its end and lists what broke: with harnesses of nothing."""

import re
import subprocess
import sys
import types
from pathlib import Path

import pytest

from tools.bench import __main__ as driver
from tools.bench.verdicts import Verdict

ROOT = Path(__file__).parents[2]
KEPT = Verdict("a stack: time over a loop's", 0.5, 1.0)
BROKEN = Verdict("a frame: time over counting's", 1.014, 1.0)
NOTHING_FOUND = Verdict("a spot: error over the bound", float("nan"), 1.3)
EXCUSED = Verdict("a template: error over the bound", 10.6, 1.3, cannot="two levels")


def harness(*verdicts):
    def run():
        print(f"table of {len(verdicts)}")
        return list(verdicts)

    return run


def failing(error):
    def run():
        print("half a table")
        raise error

    return run


def test_limits_that_are_kept_or_excused_end_well(capsys):
    assert driver.bench({"one": harness(KEPT, EXCUSED), "two": harness(KEPT)}) == 0
    out = capsys.readouterr().out
    assert out.endswith("==== limits\n\n2 kept, 0 broken\n")
    assert "BROKEN" not in out


def test_a_broken_limit_hides_none_that_follows(capsys):
    found = {"one": harness(BROKEN, KEPT), "two": harness(KEPT), "three": harness(NOTHING_FOUND)}
    assert driver.bench(found) == 1
    out = capsys.readouterr().out
    tables, summary = out.split("==== limits\n")
    assert [line for line in tables.splitlines() if line] == [
        "==== one", "table of 2", "==== two", "table of 1", "==== three", "table of 1",
    ]  # fmt: skip
    assert summary.strip().splitlines() == [
        "2 kept, 2 broken:",
        f"  BROKEN one: {BROKEN.what}: 1.014, limit 1",
        f"  BROKEN three: {NOTHING_FOUND.what}: nan, limit 1.3",
    ]


@pytest.mark.parametrize(
    "error", [ValueError("shapes\nof two lines"), ImportError("no photutils"), KeyError("x")]
)
def test_a_harness_that_fails_is_broken_and_the_next_still_runs(capsys, error):
    assert driver.bench({"one": failing(error), "two": harness(KEPT)}) == 1
    out = capsys.readouterr().out
    assert "half a table" in out
    assert "table of 1" in out
    assert f"{type(error).__name__}" in out.partition("==== two")[0], "with its traceback"
    [complaint] = [line for line in out.splitlines() if "BROKEN" in line]
    assert complaint.startswith("  BROKEN one: ")
    assert type(error).__name__ in complaint
    assert "1 kept, 1 broken:" in out


def test_a_harness_that_judges_nothing_is_broken(capsys):
    assert driver.bench({"one": harness()}) == 1
    assert "BROKEN one: judged nothing" in capsys.readouterr().out


def test_ctrl_c_is_not_a_broken_limit():
    with pytest.raises(KeyboardInterrupt):
        driver.bench({"one": failing(KeyboardInterrupt())})


def test_every_module_that_measures_is_run():
    """Whatever can be called alone belongs to `make bench`."""
    run = re.compile(r"^def run\((seed: int)?(, [^)]*)?\) -> list\[Verdict\]:", re.MULTILINE)
    modules = {
        path.stem
        for path in Path(driver.__file__).parent.glob("*.py")
        if run.search(path.read_text(encoding="utf-8"))
    }
    assert modules == set(driver.NAMES) == set(driver.harnesses(1))
    assert set(driver.NAMES) >= driver.SEEDED


def test_what_a_harness_cannot_import_is_no_reason_to_leave_out_the_next(monkeypatch, capsys):
    monkeypatch.setattr(driver, "NAMES", ("no_such_harness",))
    assert driver.bench({**driver.harnesses(1), "two": harness(KEPT)}) == 1
    out = capsys.readouterr().out
    assert "no_such_harness" in out
    assert "table of 1" in out


def test_the_exit_status_of_the_command_is_that_of_the_bench():
    """As `make bench` sees it."""
    code = (
        "import runpy, sys, types, importlib\n"
        "from tools.bench.verdicts import Verdict\n"
        "real = importlib.import_module\n"
        "def fake(name, *rest):\n"
        "    if not name.startswith('tools.bench.'):\n"
        "        return real(name, *rest)\n"
        "    value = 2.0 if name.endswith('service') else 0.5\n"
        "    return types.SimpleNamespace(run=lambda *seed: [Verdict(name, value, 1.0)])\n"
        "importlib.import_module = fake\n"
        "runpy.run_module('tools.bench', run_name='__main__')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    assert f"{len(driver.NAMES) - 1} kept, 1 broken:" in done.stdout
    assert "BROKEN service: tools.bench.service: 2, limit 1" in done.stdout


def test_the_seed_is_drawn_said_first_and_handed_to_whoever_draws(monkeypatch, capsys):
    given = {}

    def imported(name):
        def run(*seed):
            given[name.rpartition(".")[2]] = seed
            return [KEPT]

        return types.SimpleNamespace(run=run)

    monkeypatch.setattr(driver, "import_module", imported)
    monkeypatch.setattr(driver, "new_seed", lambda: 123456)
    for arguments, seed in (([], 123456), (["--seed", "7"], 7)):
        assert driver.main(arguments) == 0
        assert capsys.readouterr().out.startswith(f"seed {seed}\n")
        seeded = {name: (seed,) if name in driver.SEEDED else () for name in driver.NAMES}
        assert given == seeded
