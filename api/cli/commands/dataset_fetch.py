"""`sunatlas dataset fetch`: public sets of real readings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli.wrong_call import WrongCallError


def fetch(
    name: Annotated[
        str | None,
        typer.Argument(help="Name of the set; without one they are listed.", show_default=False),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output directory; by default the set's name.")
    ] = None,
) -> None:
    """Download real readings from their public source, checked by SHA-256.

    Nothing is bundled: licence and citation are written beside the readings.
    `sunatlas calibrate` reads the files.
    """
    from api.real.fetching import fetch as run  # noqa: PLC0415 - of this command
    from api.real.sets import SETS  # noqa: PLC0415 - as above

    if name is None:
        for one in SETS.values():
            typer.echo(f"{one.name}: {one.about} ({one.licence})")
        return
    if name not in SETS:
        raise WrongCallError(
            f"there is no set of real readings {name!r} (there are {', '.join(SETS)})"
        )
    written = run(SETS[name], out or Path(name))
    typer.echo(f"wrote {', '.join(path.name for path in written)} in {out or name}")
    typer.echo(f"cite: {SETS[name].citation}")
