"""`sunatlas completion`: the script by which a shell completes its words."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from api.cli.options import VARIABLE


class Shell(StrEnum):
    """Shells that can complete."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"


def completion(shell: Annotated[Shell, typer.Argument(help="Shell.")]) -> None:
    """Print the shell completion script.

    Bash: `eval "$(sunatlas completion bash)"` in ~/.bashrc. Zsh: the same with zsh in ~/.zshrc,
    after compinit. Fish: `sunatlas completion fish > ~/.config/fish/completions/sunatlas.fish`. It
    completes commands and the names of data sets, conditions, extractors, models, studies and
    claims.
    """
    from typer._completion_shared import get_completion_script  # noqa: PLC0415 - Typer has no public name for it

    script = get_completion_script(prog_name="sunatlas", complete_var=VARIABLE, shell=shell.value)
    typer.echo(script)
