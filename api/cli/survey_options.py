"""Options of several commands on the survey's tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

DataOption = Annotated[
    Path | None, typer.Option(help="Directory of the tables; by default those of the Atlas.")
]
ApplyOption = Annotated[
    bool, typer.Option("--apply", help="Write the changes; otherwise only show them.")
]
