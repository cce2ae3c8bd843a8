"""`sunatlas studies`: references as the service gives them, and what one study's page says."""

from __future__ import annotations

from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from tests.api.conftest import Client

FORMS = ("bibtex", "csl")
#: Mapped by the survey and scored here; not mapped by it.
STUDY, LATER = "Chang2008", "Herman2025c"


def shown(*arguments: str) -> Any:
    found = CliRunner(env={"COLUMNS": "400"}).invoke(app, ["studies", *arguments])
    assert found.exit_code == 0, found.stderr
    return found


@pytest.mark.parametrize("form", FORMS)
def test_references_are_those_of_the_service(atlas: Client, form: str) -> None:
    printed = shown("--detector", "Event", "--edition", "all", "--format", form)
    served = atlas.get(f"/v1/studies?detector=Event&edition=all&format={form}")
    assert served.status_code == 200
    assert printed.stdout == served.text
    one = shown(STUDY, "--format", form)
    assert one.stdout == atlas.get(f"/v1/studies/{STUDY}?format={form}").text
    assert one.stderr == ""


def test_studies_without_a_title_have_no_reference_and_are_named(atlas: Client) -> None:
    untitled = [one["key"] for one in atlas.walk("/v1/studies?limit=500") if not one["title"]]
    assert untitled
    printed = shown("--format", "bibtex")
    named = ", ".join(untitled)
    assert printed.stderr == f"sunatlas: no title is known of {named}: left out\n"
    assert not any(f"{{{key}," in printed.stdout for key in untitled)
    assert f"{{{STUDY}," in printed.stdout
    alone = shown(untitled[0], "--format", "ris")
    assert f"of {untitled[0]}: left out" in alone.stderr
    assert untitled[0] not in alone.stdout
