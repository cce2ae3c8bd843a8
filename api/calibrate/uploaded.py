"""Files that strangers send: calibrated by a process of its own, within time and memory.

The files lie in a temporary directory that is gone at the end. The process reads nothing else of
what it is sent names of, and what it is sent is never run.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from files.temporary import temporary_directory

#: Bytes of all files together and of a config, seconds, and bytes of memory of a calibration.
LARGEST, LARGEST_CONFIG, LONGEST_S, MOST_MEMORY = 10_000_000, 20_000, 60.0, 3 * 2**30
#: Files and rows of a calibration.
MOST_FILES, MOST_ROWS = 20, 100_000
_TASK, _SAID = "task.json", "said.json"
_NAME = re.compile(r"[^A-Za-z0-9._-]+")


class UploadRefusedError(ValueError):
    """Files that cannot be calibrated; the message says why, and where."""


@dataclass(frozen=True)
class Upload:
    """A file as it was sent.

    Attributes
    ----------
    name : str
        As the sender calls it.
    data : bytes
    """

    name: str
    data: bytes


def calibrate_uploads(
    uploads: Sequence[Upload],
    config: str = "",
    *,
    apply: bool = False,
    model: str = "",
    longest_s: float = LONGEST_S,
) -> dict[str, str]:
    """Calibrate files in a process of its own; returns the text of each product by its name.

    Parameters
    ----------
    uploads : sequence of Upload
        Each a run of one sensor.
    config : str
        TOML, as `api.calibrate.settings.read_settings` takes it; columns are guessed where empty.
    apply : bool
        Whether conventions found with certainty are applied.
    model : str
        The only one tried; all that apply where empty.
    longest_s : float
        Seconds after which the process is ended.

    Raises
    ------
    UploadRefusedError
        If the files are too large or no calibration settles them.
    """
    _require_bounds(uploads, config)
    with temporary_directory() as directory:
        names = [_safe(one.name, number) for number, one in enumerate(uploads)]
        for name, one in zip(names, uploads, strict=True):
            (directory / name).parent.mkdir()
            (directory / name).write_bytes(one.data)
        task = {"names": names, "config": config, "apply": apply, "model": model}
        (directory / _TASK).write_text(json.dumps(task), "utf-8")
        try:
            done = subprocess.run(  # noqa: S603 - this interpreter, and a directory made here
                [sys.executable, "-m", "api.calibrate.uploaded", str(directory)],
                check=False, timeout=longest_s, stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise UploadRefusedError(
                f"the calibration took over {longest_s:g} s; send fewer rows, or run `sunatlas "
                "calibrate`, which has no limit"
            ) from None
        said = directory / _SAID
        if done.returncode or not said.is_file():
            raise UploadRefusedError(
                "the calibration ended early, most likely for want of memory; send fewer rows"
            )
        found: dict[str, dict[str, str]] = json.loads(said.read_text("utf-8"))
    if "refused" in found:
        raise UploadRefusedError(found["refused"]["why"])
    return found["products"]


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


def _calibrate(directory: Path) -> dict[str, dict[str, str]]:
    from algorithms.contract import UnusableDataError  # noqa: PLC0415 - of the process
    from api.calibrate.calibration import calibrate  # noqa: PLC0415 - as above
    from api.calibrate.products import products  # noqa: PLC0415 - as above
    from api.calibrate.settings import (  # noqa: PLC0415 - as above
        SettingsError,
        parse_settings,
        parse_toml,
    )
    from api.calibrate.table import TableError, read_table  # noqa: PLC0415 - as above

    task = json.loads((directory / _TASK).read_text("utf-8"))
    paths = [directory / name for name in task["names"]]
    try:
        settings = None
        if task["config"].strip():
            settings = parse_settings(parse_toml(task["config"], "config"), "config")
        layout = None if settings is None else settings.file
        rows = sum(len(read_table(path, layout)) for path in paths)
        if rows > MOST_ROWS:
            return {"refused": {"why": f"expected at most {MOST_ROWS} rows in all; got {rows}"}}
        models = [task["model"]] if task["model"] else None
        found = calibrate(paths, settings, apply=task["apply"], models=models)
        return {"products": products(found, "sun_sensor", "POST /v1/calibrations")}
    except (TableError, SettingsError, UnusableDataError) as error:
        return {"refused": {"why": str(error)}}
    except (MemoryError, RecursionError):
        return {"refused": {"why": "the files need more memory than a calibration may take"}}


def main(arguments: Sequence[str]) -> int:
    """Calibrate what lies in a directory, and leave there what came of it."""
    import resource  # noqa: PLC0415 - not on every system

    directory = Path(arguments[0])
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    seconds = int(LONGEST_S) + 5
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    (directory / _SAID).write_text(json.dumps(_calibrate(directory)), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
