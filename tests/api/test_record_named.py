"""A board is cited by version and digest of its record, and found again by them."""

import hashlib
import subprocess

from typer.testing import CliRunner

from api.cli.command_line import app
from api.metadata.identity import version
from api.service.measurements import Measurements
from benchmark.datasets.pins import Pin
from benchmark.results.components import Components
from benchmark.results.store import PUBLISHED, Store

NAME = "cmos-single-aperture"


def write(directory, bound):
    pin = Pin(NAME, "nominal", "test", 1, 400, "a" * 32, "c" * 32, 400, bound, bound)
    Store(directory).write({}, [pin], Components())
    return Measurements(directory).record["sha256"]


def git(directory, *arguments):
    who = ("-c", "user.name=a", "-c", "user.email=a@example.org")
    command = ["git", *who, "-C", str(directory), *arguments]
    return subprocess.run(command, check=True, capture_output=True).stdout


def test_the_recipe_finds_the_tag_of_a_cited_board(tmp_path):
    """docs/guide/scores.md: the digest is that of checksums-sha256.txt at the tag."""
    git(tmp_path, "init", "--quiet")
    shown = []
    for tag, bound in (("v1", 0.25), ("v2", 0.5)):
        shown.append(write(tmp_path / "benchmark" / "published", bound))
        git(tmp_path, "add", "--all")
        git(tmp_path, "commit", "--quiet", "--message", tag)
        git(tmp_path, "tag", tag)
    manifests = [
        git(tmp_path, "show", f"{t}:benchmark/published/checksums-sha256.txt") for t in ("v1", "v2")
    ]
    assert [hashlib.sha256(m).hexdigest() for m in manifests] == shown
    git(tmp_path, "checkout", "--quiet", "v1")
    assert Measurements(tmp_path / "benchmark" / "published").record["sha256"] == shown[0]


def test_service_page_command_and_citation_name_the_same_record(atlas):
    record = atlas.get("/v1/leaderboard").json()["record"]
    manifest = (PUBLISHED / "checksums-sha256.txt").read_bytes()
    assert record == {"version": version(), "sha256": hashlib.sha256(manifest).hexdigest()}
    assert record["sha256"] == atlas.get("/healthz").json()["record_sha256"]
    assert record["sha256"] in atlas.get("/leaderboard", accept="text/html").text
    said = CliRunner().invoke(app, ["leaderboard"]).stderr
    assert said == f"Record: version {version()}, sha256 {record['sha256']}\n"
