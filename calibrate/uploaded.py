"""Files that strangers send: calibrated by a process of its own, within time and memory.

The files lie in a temporary directory that is gone at the end. The process reads nothing else of
what it is sent names of, and what it is sent is never run. It ends, and removes the files, when the
caller no longer waits for it or ends, however that ends.
"""

from __future__ import annotations

import json
import logging
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from algorithms.contract import UnusableDataError
from calibrate.calibration import calibrate
from calibrate.products import products
from calibrate.report.page import Asked
from calibrate.report.requirement import RequirementError, requirement
from calibrate.settings import SettingsError, parse_settings, parse_toml
from calibrate.table import TableError
from calibrate.template import preview
from files.atomic import temporary_directory

#: Bytes of all files together and of a config, seconds of the processor, and bytes of memory of a
#: calibration: of 100,000 rows it takes half of both.
LARGEST, LARGEST_CONFIG, LONGEST_S, MOST_MEMORY = 10_000_000, 20_000, 60.0, 2**30
#: A busy machine takes so many times as long.
_PATIENCE = 3.0
#: Files and rows of a calibration.
MOST_FILES, MOST_ROWS = 20, 100_000
_LONGEST_FAULT = 200
_TASK, _SAID = "task.json", "said.json"
#: The process steps back behind answers, from before it loads anything. Not to the lowest priority:
#: beside other work that keeps the machine busy it would load for minutes.
_BEGIN = """
import os, runpy
os.setpriority(os.PRIO_PROCESS, 0, max(10, os.getpriority(os.PRIO_PROCESS, 0)))
runpy.run_module("calibrate.uploaded", run_name="__main__", alter_sys=True)
"""
_NAME = re.compile(r"[^A-Za-z0-9._-]+")


class UploadRefusedError(ValueError):
    """Files that cannot be calibrated; the message says why, and where."""


@dataclass(frozen=True)
class Upload:
    """A file as it was sent."""

    name: str  # as the sender calls it
    data: bytes


class Caller:
    """Who waits for a calibration in a process of its own: a pipe that the process reads.

    The system closes it with the process that made it, even where that is killed.
    """

    def __init__(self) -> None:
        read, write = os.pipe()
        self._read, self._write = os.fdopen(read, "rb"), os.fdopen(write, "wb")

    @property
    def end(self) -> int:
        """The end that the process reads."""
        return self._read.fileno()

    @property
    def is_gone(self) -> bool:
        """Whether the caller has hung up."""
        return self._write.closed

    def hang_up(self) -> None:
        """Wait no longer: the process ends, or will as soon as it begins."""
        self._write.close()

    def close(self) -> None:
        """Close both ends, when the process has ended."""
        self._write.close()
        self._read.close()


def calibrate_uploads(
    uploads: Sequence[Upload],
    config: str = "",
    *,
    apply: bool = False,
    model: str = "",
    require: str = "",
    longest_s: float | None = None,
    caller: Caller | None = None,
) -> dict[str, str]:
    """Calibrate files in a process of its own; returns the text of each product by its name.

    Parameters
    ----------
    uploads : sequence of Upload
        Each a run of one sensor.
    config : str
        TOML, as `calibrate.settings.read_settings` takes it; columns are guessed where empty.
    apply : bool
        Whether conventions found with certainty are applied.
    model : str
        The only one tried; all that apply where empty.
    require : str
        A requirement on the error, as `calibrate.report.requirement` reads it; none if empty.
    longest_s : float, optional
        Seconds after which the process is ended; by default thrice `LONGEST_S`, which its
        processor time is bounded by.
    caller : Caller, optional
        Who may hang up meanwhile; refused then.

    Raises
    ------
    UploadRefusedError
        If the files are too large or no calibration settles them.
    """
    task = {"config": config, "apply": apply, "model": model, "require": require}
    found: dict[str, str] = _answered(uploads, task, longest_s, caller or Caller())
    return found


def preview_uploads(
    uploads: Sequence[Upload], longest_s: float | None = None, caller: Caller | None = None
) -> dict[str, Any]:
    """Return what the first file seems to hold, as `calibrate.template.preview` says it.

    UploadRefusedError if the files are too large, or the first is no table.
    """
    task = {"config": "", "preview": True}
    found: dict[str, Any] = _answered(uploads, task, longest_s, caller or Caller())
    return found


def _answered(
    uploads: Sequence[Upload], task: dict[str, Any], longest_s: float | None, caller: Caller
) -> Any:
    """Return what a process of its own answers to a task on files."""
    longest_s = _PATIENCE * LONGEST_S if longest_s is None else longest_s
    with closing(caller), temporary_directory() as directory:
        _require_bounds(uploads, str(task["config"]))
        names = [_safe(one.name, number) for number, one in enumerate(uploads)]
        for name, one in zip(names, uploads, strict=True):
            (directory / name).parent.mkdir()
            (directory / name).write_bytes(one.data)
        (directory / _TASK).write_text(json.dumps({**task, "names": names}), "utf-8")
        if caller.is_gone:  # else a busy machine would load the program to no end
            raise UploadRefusedError("the caller hung up before the calibration began")
        try:
            done = subprocess.run(  # noqa: S603 - this interpreter, and a directory made here
                [sys.executable, "-c", _BEGIN, str(directory)],
                check=False, timeout=longest_s, stdin=caller.end,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise UploadRefusedError(_too_long(longest_s)) from None
        said = directory / _SAID
        if done.returncode or not said.is_file():
            raise UploadRefusedError(_ended(done.returncode))
        found: dict[str, Any] = json.loads(said.read_text("utf-8"))
    if "fault" in found:
        logging.getLogger("sunatlas").error("a calibration failed:\n%s", found["trace"])
        raise UploadRefusedError(
            f"the program failed on these files ({found['fault']}); this is a fault of the program"
        )
    if "refused" in found:
        raise UploadRefusedError(found["refused"])
    return found["answer"]


def _ended(status: int) -> str:
    """Say how a process ended that left no answer."""
    if status == -signal.SIGXCPU:
        return _too_long(LONGEST_S)
    if status == -signal.SIGKILL:
        return "the calibration was killed, most likely for want of memory; send fewer rows"
    if status < 0:
        names = {one.value: one.name for one in signal.Signals}
        return f"the calibration was ended by {names.get(-status, f'signal {-status}')}"
    return f"the calibration ended without an answer (exit code {status}); this is a fault of ours"


def _too_long(seconds: float) -> str:
    return (
        f"the calibration took over {seconds:g} s; send fewer rows, or run `sunatlas calibrate`, "
        "which has no limit"
    )


def _require_bounds(uploads: Sequence[Upload], config: str) -> None:
    size = sum(len(one.data) for one in uploads)
    if not 1 <= len(uploads) <= MOST_FILES:
        raise UploadRefusedError(f"expected 1 to {MOST_FILES} files; got {len(uploads)}")
    if size > LARGEST:
        raise UploadRefusedError(f"expected at most {LARGEST} bytes; got {size}")
    if len(config) > LARGEST_CONFIG:
        raise UploadRefusedError(
            f"config: expected at most {LARGEST_CONFIG} characters; got {len(config)}"
        )


def _safe(name: str, number: int) -> str:
    """Return a name of a file in the directory, whatever the sender's says of others."""
    plain = _NAME.sub("_", re.split(r"[/\\]", name)[-1])[-60:].lstrip(".") or "file"
    return f"{number}/{plain}"


def _answer(directory: Path) -> dict[str, Any]:
    """Return the answer, why there is none, or the program's fault."""
    task = json.loads((directory / _TASK).read_text("utf-8"))
    paths = [directory / name for name in task["names"]]
    refusals = (TableError, SettingsError, RequirementError, UnusableDataError)
    try:
        return {"answer": preview(paths[0]) if task.get("preview") else _made(paths, task)}
    except refusals as error:
        return {"refused": str(error)}
    except MemoryError:
        return {"refused": "the files need more memory than a calibration may take"}
    except Exception as error:  # noqa: BLE001 - what is said is what went wrong
        said = f"{type(error).__name__}: {error}"
        return {"fault": said[:_LONGEST_FAULT], "trace": traceback.format_exc()}


def _made(paths: Sequence[Path], task: dict[str, Any]) -> dict[str, str]:
    settings = None
    if task["config"].strip():
        settings = parse_settings(parse_toml(task["config"], "config"), "config")
    asked = (requirement(task["require"]),) if task.get("require", "").strip() else ()
    models = [task["model"]] if task["model"] else None
    found = calibrate(paths, settings, apply=task["apply"], models=models, most_rows=MOST_ROWS)
    return products(found, "sun_sensor", "POST /v1/calibrations", Asked(asked))


def main(arguments: Sequence[str]) -> int:
    """Calibrate what lies in a directory, and leave there what came of it."""
    import resource  # noqa: PLC0415 - not on every system

    directory = Path(arguments[0])
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
    seconds = int(LONGEST_S)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # no file keeps what it was sent
    (directory / _SAID).write_text(json.dumps(_answer(directory)), "utf-8")
    return 0


def _end_with_caller(directory: Path) -> Callable[[], None]:
    """End this process, and remove its files, once nobody waits for it: its input ends then.

    Returns what waits for that where it has begun: files that are gone are no reason to end first.
    """
    begun = threading.Event()

    def wait() -> None:
        os.read(0, 1)
        begun.set()
        shutil.rmtree(directory, ignore_errors=True)
        os._exit(1)

    ending = threading.Thread(target=wait, daemon=True, name="end with the caller")
    ending.start()
    return lambda: ending.join() if begun.is_set() else None


if __name__ == "__main__":
    wait_for_end = _end_with_caller(Path(sys.argv[1]))
    try:
        sys.exit(main(sys.argv[1:]))
    finally:
        wait_for_end()
