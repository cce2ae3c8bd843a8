"""`sunatlas`: the command line.

Each command lives in its own module of `api.cli.commands`, imported only when it is asked for, so
that `sunatlas --help` costs no more than Typer itself. What is known to go wrong ends here, in one
line on stderr: exit code 2 for a wrong call, 1 for a refused or failed one, 130 after Ctrl-C, 143
after a request to terminate (SIGTERM), which is handled as Ctrl-C is. Known are errors of the file
system and the classes of error this project defines; anything else is a mistake in a program, and
ends with its traceback.
"""

from __future__ import annotations

import contextlib
import errno
import importlib
import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from api.cli.spreadsheets import offer
from benchmark.processes import (
    INTERRUPTED,
    exit_code,
    say_interrupted,
    terminate_as_interrupt,
    termination_requested,
)

# name -> its line in `sunatlas --help`; the module is api.cli.commands.<name>.
COMMANDS: dict[str, str] = {
    "serve": "Serve the web pages, the guide and the HTTP API.",
    "survey": "Check the survey's tables, import or add studies.",
    "studies": "List studies with the grade of each run, or show one.",
    "recommend": "Rank sensors and calibrations that meet your requirements.",
    "plan": "List the cells that need measuring, with reasons.",
    "run": "Run the pipelines of a study, or a suite.",
    "verify": "Measure a random sample of published cells again.",
    "gc": "Delete unused results from the local store.",
    "benchmark": "Score pipelines on the standard data sets.",
    "rank": "Check and measure an algorithm, and show its rank.",
    "leaderboard": "Show the leaderboard, update it or check it.",
    "compare": "Compare architectures, or masks at equal height.",
    "figures": "Print errors claimed, simulated and possible.",
    "curves": "Show how many calibration poses pipelines need.",
    "assess": "Compare the survey's scores of extractors with ours.",
    "claims": "Show claims of the survey, with verdicts.",
    "directions": "Show the survey's future directions, with verdicts.",
    "calibrate": "Calibrate your own sensor from a turntable file.",
    "dataset": "List, describe, export or verify the standard data sets.",
    "deposit": "Build, verify, upload or publish the archive bundle.",
    "guide": "Build the guide, served at /guide.",
    "get": "Answer an address of the HTTP API without a server.",
    "completion": "Print the shell completion script.",
    "compile": "Compile all numerical kernels now.",
}
#: Packages that not every command needs, and the extras that bring them.
EXTRAS = {
    **dict.fromkeys(("hatchling", "httpx", "tenacity"), "deposit"),
    **dict.fromkeys(("distributed",), "cluster"),
    **dict.fromkeys(("torch",), "learn"),
    **dict.fromkeys(("furo", "myst_parser", "sphinx"), "guide"),
    **dict.fromkeys(
        (
            *("fastapi", "fastapi_offline", "latex2mathml", "plotly", "prometheus_client"),
            *("python_multipart", "starlette", "uvicorn"),
        ),
        "serve",
    ),
}
DEBUG = "SUNATLAS_DEBUG"
_NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF})
_OURS = frozenset(
    {"algorithms", "api", "benchmark", "calibrate", "files", "registry", "survey_data"}
)


class LazyCommands(TyperGroup):
    """A group whose commands are imported when they are run, not when they are listed."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name, line in COMMANDS.items():
            self.add_command(TyperCommand(name, help=line, rich_markup_mode=None))

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Import the module of the command to run; a usage error names the nearest one."""
        name, command, rest = super().resolve_command(ctx, args)
        return name, command and load(str(name)), rest

    def invoke(self, ctx: Any) -> Any:
        """Run the command; one that is broken off says so in a line."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:
            say_interrupted(f"sunatlas: {str(error) or 'interrupted'}")
            raise

    def main(self, args: Sequence[str] | None = None, *rest: Any, **extra: Any) -> Any:
        """Run, and turn what goes wrong into an exit code and one line on stderr."""
        extra["standalone_mode"] = False
        _open_streams()
        if os.environ.get("_SUNATLAS_COMPLETE"):
            from typer._completion_classes import completion_init  # noqa: PLC0415 - as Typer does

            completion_init()
        try:
            status = super().main(args, *rest, **extra)
            _flush()
        except typer.TyperException as error:
            _refuse(error)
        except typer.Abort as error:
            _stop(error, 1, "aborted")
        except BrokenPipeError:
            # The reader has gone (`sunatlas studies | head`): nobody is left to read.
            _drop_output()
            sys.exit(1)
        except KeyboardInterrupt:
            status = INTERRUPTED
        except OSError as error:
            _stop(error, 1, f"{_where(error)}{error.strerror or error}")
        except Exception as error:
            if not (is_known(error) or termination_requested()):
                raise
            _stop(error, 1, _message(error))
        if status == INTERRUPTED:
            status = exit_code()
        sys.exit(status if isinstance(status, int) else 0)


def is_known(error: BaseException) -> bool:
    """Say whether an error is foreseen: of the file system, or of a class defined in this project.

    So is an extra that is not installed, and a lack of memory. A ValueError, KeyError or the like
    that NumPy or the interpreter raised is not.
    """
    ours = type(error).__module__.partition(".")[0] in _OURS
    missing = _missing_of(error) in EXTRAS
    return ours or isinstance(error, OSError) or missing or _lacks_memory(error)


def _lacks_memory(error: BaseException) -> bool:
    """Say whether memory is what failed; a library that finds no room says so in its words."""
    unmapped = isinstance(error, ImportError) and "failed to map segment" in str(error)
    return unmapped or isinstance(error, MemoryError)


def _missing_of(error: BaseException) -> str:
    """Return the package that is not there, where that is the error; else nothing."""
    return str(error.name).partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""


def _message(error: BaseException) -> str:
    if (missing := _missing_of(error)) in EXTRAS:
        install = f"pip install 'sun-sensor-atlas[{EXTRAS[missing]}]'"
        return f"this needs the package {missing!r}: {install}"
    if _lacks_memory(error):
        return "out of memory; allow this process more (`ulimit -v`), or use fewer --workers"
    quoted = isinstance(error, LookupError) and error.args  # str() would quote the message
    return str(error.args[0] if quoted else error)


def load(name: str) -> Any:
    """Make the command `name` from its module: of the `app` of a group, else of the function."""
    module = importlib.import_module(f"api.cli.commands.{name}")
    if (made := getattr(module, "app", None)) is None:
        made = typer.Typer(add_completion=False, rich_markup_mode=None)
        made.command()(getattr(module, name))
    command = typer.main.get_command(made)
    command.name, command.help = name, command.help or COMMANDS[name]
    offer(command)
    return command


def _refuse(error: Any) -> None:
    """End a wrong call: where nothing is asked, with what can be asked."""
    context = getattr(error, "ctx", None)
    if context is not None and error.message == "Missing command.":
        typer.echo(context.get_help())
        sys.exit(error.exit_code)
    from api.cli.refusals import usage_message  # noqa: PLC0415 - the help does without it

    _stop(error, error.exit_code, usage_message(error))


def _open_streams() -> None:
    """Make writes to a closed stream raise, and replace characters a stream cannot encode.

    Python leaves None where a closed stream was (`sunatlas studies >&-`).
    """
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115, PTH123 - for as long as the process is
    if sys.stdout is None:
        _stop(OSError(), 1, "standard output is closed")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")


def _flush() -> None:
    """Write what is still to be written; a failure is reported as one of standard output."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        _drop_output()
        raise OSError(error.errno, error.strerror, "standard output") from error


def _where(error: OSError) -> str:
    """Name the file of an error; what cannot be written and has no name is standard output."""
    if error.filename:
        path = Path(os.fsdecode(error.filename))
        hidden = path.name.startswith(".") and path.suffix in {".lock", ".sunatlas"}
        return f"cannot write in {path.parent}: " if hidden else f"{path}: "
    if error.errno in _NO_ROOM:  # files that cannot be written are named where they are
        _drop_output()
        return "standard output: "
    return ""


def _drop_output() -> None:
    """Let what cannot be written to standard output be forgotten, also when Python ends."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _stop(error: BaseException, code: int, message: str) -> None:
    if termination_requested():  # then whatever went wrong did so because of that
        say_interrupted("sunatlas: interrupted")
        sys.exit(exit_code())
    if os.environ.get(DEBUG):
        raise error
    line = " ".join(message.split())
    # what a file or a server says may hold what a terminal obeys, or what turns its line
    shown = "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in line)
    typer.echo(f"sunatlas: {shown}", err=True)
    sys.exit(code)


def _version(wanted: bool) -> None:
    if wanted:
        from api.metadata import identity as deposit_identity  # noqa: PLC0415 - the help does without it

        typer.echo(f"sunatlas {deposit_identity.version()}")
        raise typer.Exit


app = typer.Typer(
    cls=LazyCommands,
    name="sunatlas",
    add_completion=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def sunatlas(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Which sun sensor to build and how to calibrate it: studies, algorithms, measurements.

    Commands that print a table take --format table, json or csv, and --safe for CSV that a
    spreadsheet is to open.
    """


def main() -> None:
    """Entry point of the console script."""
    terminate_as_interrupt()
    typer.main.get_command(app).main(prog_name="sunatlas")


if __name__ == "__main__":
    main()
