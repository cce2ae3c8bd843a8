"""The glossary's page."""

from __future__ import annotations

import os
from pathlib import PurePosixPath

from api.docs.markdown import table
from api.glossary import glossary

_FOLDER = "guide"


def terms() -> str:
    """List the words of this project."""
    rows = [
        (f"**{one.term}**", one.name if one.name != one.term else "", one.meaning, _see(one.see))
        for one in glossary()
        if one.kind == "term"
    ]
    return table(("word", "in full", "what it means", "more"), rows)


def abbreviations() -> str:
    """List the survey's values with their names in full."""
    rows = [(f"**{one.term}**", one.name, one.meaning) for one in glossary() if one.kind != "term"]
    return table(("as written", "in full", "what it is"), rows)


def _see(target: str) -> str:
    if not target:
        return ""
    page, _, anchor = target.partition("#")
    path = os.path.relpath(page, _FOLDER)
    name = PurePosixPath(page).stem.replace("-", " ")
    return f"[{name}]({path}{f'#{anchor}' if anchor else ''})"
