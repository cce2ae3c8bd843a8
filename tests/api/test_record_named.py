"""A board is cited by version and digest of its record."""

import hashlib

from typer.testing import CliRunner

from api.cli.command_line import app
from api.metadata.identity import version
from benchmark.results.store import PUBLISHED


def test_service_page_command_and_citation_name_the_same_record(atlas):
    record = atlas.get("/v1/leaderboard").json()["record"]
    manifest = (PUBLISHED / "checksums-sha256.txt").read_bytes()
    assert record == {"version": version(), "sha256": hashlib.sha256(manifest).hexdigest()}
    assert record["sha256"] == atlas.get("/healthz").json()["record_sha256"]
    assert record["sha256"] in atlas.get("/leaderboard", accept="text/html").text
    said = CliRunner().invoke(app, ["leaderboard"]).stderr
    assert said.splitlines()[-1] == f"Record: version {version()}, sha256 {record['sha256']}"
