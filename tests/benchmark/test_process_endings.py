"""How a process ends, told without ending the one that runs the tests."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest

from benchmark import processes
from files.locks import LockedError


def raiser(error: BaseException) -> Callable[[], int]:
    def main() -> NoReturn:
        raise error

    return main


@pytest.fixture
def calm(monkeypatch: pytest.MonkeyPatch) -> None:
    """Signals of this process stay as they are, and nothing has asked it to end."""
    monkeypatch.setattr(processes, "terminate_as_interrupt", lambda: None)
    monkeypatch.setattr(processes, "_told", [])
    monkeypatch.setattr(processes, "_said", threading.Event())
    monkeypatch.delenv(processes.COORDINATOR, raising=False)


@pytest.mark.usefixtures("calm")
@pytest.mark.parametrize(
    ("main", "code", "said"),
    [
        (lambda: 3, 3, ""),
        (raiser(KeyboardInterrupt()), 130, "interrupted\n"),
        (raiser(KeyboardInterrupt("half is done")), 130, "half is done\n"),
        (raiser(LockedError("process 7", Path("out"), "7 is writing")), 1, "7 is writing\n"),
    ],
)
def test_a_program_ends_with_the_code_of_what_ended_it(
    main: Callable[[], int], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ending:
        processes.call_to_end(main)
    assert ending.value.code == code
    assert capsys.readouterr().err == said
