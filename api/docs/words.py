"""The glossary's page."""

from __future__ import annotations

import os
from pathlib import PurePosixPath

from api.glossary import glossary, words

_FOLDER = "guide"


def terms() -> str:
    """List the words of this project."""
    return "\n".join(
        f"- **{one.term}**{f' ({one.name})' if one.name != one.term else ''}: {one.meaning}"
        f"{_see(one.see)}"
        for one in glossary()
        if one.kind == "term"
    )


def abbreviations() -> str:
    """List the survey's values by attribute, with their names; meanings where the table has one."""
    meanings = {one.term: one.meaning for one in words()}
    values: dict[str, list[str]] = {}
    for one in glossary():
        if one.kind == "term" or one.term == "None":
            continue
        name = f" ({one.name})" if one.name != one.term else ""
        means = f": {one.meaning}" if one.meaning == meanings.get(one.term) else ""
        values.setdefault(one.kind, []).append(f"- **{one.term}**{name}{means}")
    return "\n\n".join(
        f"### {attribute.capitalize()}\n\n" + "\n".join(listed)
        for attribute, listed in values.items()
    )


def _see(target: str) -> str:
    if not target:
        return ""
    page, _, anchor = target.partition("#")
    path = os.path.relpath(page, _FOLDER)
    name = PurePosixPath(page).stem.replace("-", " ")
    return f" [{name}]({path}{f'#{anchor}' if anchor else ''})"
