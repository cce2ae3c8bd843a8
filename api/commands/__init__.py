"""The commands of `sunatlas`, one module each with its Typer `app`; imported when they are run."""
