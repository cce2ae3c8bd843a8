"""`sunatlas`: the command line.

Each command lives in its own module of `api.cli.commands`, imported only when it is asked for, so
that `sunatlas --help` costs no more than Typer itself. What is known to go wrong ends here, in one
line on stderr: exit code 2 for a wrong call, 1 for a refused or failed one, 130 after Ctrl-C. Known
are errors of the file system and the classes of error this project defines; anything else is a
mistake in a program, and ends with its traceback.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

# name -> its line in `sunatlas --help`; the module is api.cli.commands.<name>.
COMMANDS: dict[str, str] = {
    "serve": "Serve the page and the HTTP interface.",
    "survey": "Check the survey's tables, or import the authors' own.",
    "studies": "List the studies and how far each one runs, or show one.",
    "recommend": "Rank the sensors and calibrations that meet requirements.",
    "run": "Run a study's pipelines on the data of its architecture.",
    "benchmark": "Score pipelines on the standard datasets.",
    "leaderboard": "Show the leaderboard, bring it up to date or check it.",
    "assess": "Show the survey's scores of extractors beside measured ones.",
    "dataset": "List, describe, export or verify the standard datasets.",
    "deposit": "Build or verify the bundle an archive takes.",
    "compile": "Compile every kernel now instead of at its first call.",
}
DEBUG = "SUNATLAS_DEBUG"
INTERRUPTED = 130
_OURS = frozenset({"algorithms", "api", "benchmark", "registry", "survey_data"})


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

    def main(self, args: Sequence[str] | None = None, *rest: Any, **extra: Any) -> Any:
        """Run, and turn what goes wrong into an exit code and one line on stderr."""
        extra["standalone_mode"] = False
        try:
            status = super().main(args, *rest, **extra)
            sys.stdout.flush()
        except typer.TyperException as error:
            _stop(error, error.exit_code, error.format_message())
        except typer.Abort as error:
            _stop(error, 1, "aborted")
        except BrokenPipeError:
            # The reader has gone (`sunatlas studies | head`): nobody is left to be told.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(1)
        except KeyboardInterrupt:
            status = INTERRUPTED
        except OSError as error:
            where = f"{error.filename}: " if error.filename else ""
            _stop(error, 1, f"{where}{error.strerror or error}")
        except Exception as error:
            if not is_known(error):
                raise
            quoted = isinstance(error, LookupError) and error.args  # str() would quote the message
            _stop(error, 1, str(error.args[0] if quoted else error))
        sys.exit(status if isinstance(status, int) else 0)


def is_known(error: BaseException) -> bool:
    """Say whether an error is foreseen: of the file system, or of a class defined in this project.

    A ValueError, KeyError or the like that NumPy or the interpreter raised is not.
    """
    return isinstance(error, OSError) or type(error).__module__.partition(".")[0] in _OURS


def load(name: str) -> Any:
    """Make the command `name` from the `app` of its module."""
    app = importlib.import_module(f"api.cli.commands.{name}").app
    command = typer.main.get_command(app)
    command.name = name
    return command


def _stop(error: BaseException, code: int, message: str) -> None:
    if os.environ.get(DEBUG):
        raise error
    typer.echo(f"sunatlas: {' '.join(message.split())}", err=True)
    sys.exit(code)


def _version(wanted: bool) -> None:
    if wanted:
        from api.deposit import identity as deposit_identity  # noqa: PLC0415 - the help does without it

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

    Commands that print a table take --format table, json or csv.
    """


def main() -> None:
    """Entry point of the console script."""
    typer.main.get_command(app).main(prog_name="sunatlas")


if __name__ == "__main__":
    main()
