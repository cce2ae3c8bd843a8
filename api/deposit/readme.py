"""README.md of the bundle: what lies in it, how to read and check it, on what terms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from api.deposit.frames import FOLDER
from api.metadata.citation import repository, unfilled
from api.metadata.identity import Identity
from survey_data.editions import editions


def readme(who: Identity, descriptor: Mapping[str, Any]) -> str:
    """Write the bundle's README from its datapackage.json."""
    described = descriptor["resources"]
    files = [r for r in described if r["path"].startswith(f"{FOLDER}/")]
    survey, other = editions()
    environment = Environment(  # noqa: S701 - Markdown, of texts of our own
        loader=PackageLoader("api.deposit"),
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("README.md").render(
        who=who,
        lacking=unfilled(who.authors, repository(who.citation)),
        tables=[r for r in described if r.get("type") == "table"],
        files=files,
        sets=len({r["path"].split("/")[1] for r in files}),
        size=round(sum(r["bytes"] for r in files) / 1e6),
        survey=survey,
        other=other,
    )
