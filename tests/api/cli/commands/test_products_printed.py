"""Commands that make, send or fetch something, and what they print of it.

Files are tested elsewhere; here a fake returns the result that is printed.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.commands import deposit as command
from api.deposit import against_record, bundle
from api.deposit.archives import publishing, uploading
from api.deposit.archives.contract import Draft, PublishedRecord
from api.deposit.archives.depositions import DepositionsArchive
from api.deposit.archives.records import RecordsArchive
from api.deposit.archives.uploading import State, UploadResult
from api.deposit.bundle import Bundle
from api.deposit.verification import UNSEEN
from api.guide import site
from api.real import fetching
from api.real.sets import SETS
from benchmark.running import compiling


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, call, catch_exceptions=False)


# ---- compile


def test_kernels_are_compiled_by_so_many_workers_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[int] = []

    def compile_kernels(workers: int, report: Callable[[int, int, str], None]) -> int:
        report(1, 7, "pd-slit")
        asked.append(workers)
        return 7

    monkeypatch.setattr(compiling, "compile_kernels", compile_kernels)
    shown = sunatlas("compile", "--workers", 3)
    assert (shown.exit_code, shown.stderr) == (0, "")
    assert shown.stdout == "compiled what 7 data sets and extractors call\n"
    quiet = sunatlas("compile", "--quiet")
    assert (quiet.exit_code, quiet.stdout, quiet.stderr) == (0, "", "")
    assert asked == [3, 1]


# ---- guide


@pytest.fixture
def guide(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Warnings of the guide that is built; where, is added to them as the last."""
    warnings: list[str] = []
    monkeypatch.setattr(site, "keep", lambda _: list(warnings))
    monkeypatch.setattr(site, "build", lambda out, _: [*warnings, f"into {out}"])
    monkeypatch.setattr(site, "cached_site", lambda: Path("the-cache"))
    return warnings


def test_a_guide_is_built_where_it_is_asked_for_or_in_the_cache(guide: list[str]) -> None:
    kept = sunatlas("guide", "build")
    assert (kept.stdout, kept.stderr) == ("the-cache: 0 warnings\n", "")
    built = sunatlas("guide", "build", "--out", "here")
    assert (built.stdout, built.stderr) == ("here: 1 warnings\n", "into here\n")
    guide.append("a.md, line 3: no such page")
    quiet = sunatlas("guide", "build", "--quiet")
    assert (quiet.stdout, quiet.stderr) == ("", "a.md, line 3: no such page\n")


@pytest.mark.parametrize(
    ("strict", "warned", "code"),
    [(False, False, 0), (False, True, 0), (True, False, 0), (True, True, 1)],
)
def test_a_warning_fails_only_where_strictness_is_asked_for(
    guide: list[str], strict: bool, warned: bool, code: int
) -> None:
    guide.extend(["a warning"] if warned else [])
    assert sunatlas("guide", "build", *(["--strict"] if strict else [])).exit_code == code


# ---- deposit


def test_what_a_bundle_holds_is_listed_with_its_size(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def build(out: Path, *, progress: Callable[[int, int, str], None]) -> Bundle:
        progress(1, 2, "pd-slit")
        out.mkdir()
        (out / "README.md").write_text("12345")
        return Bundle(out, out.with_suffix(".zip"), ("README.md",))

    monkeypatch.setattr(bundle, "build", build)
    out = tmp_path / "bundle"
    shown = sunatlas("deposit", "build", "--out", out, "--quiet", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    assert json.loads(shown.stdout) == {
        "directory": str(out),
        "archive": f"{out}.zip",
        "files": [{"file": "README.md", "bytes": 5}],
    }
    assert shown.stderr == f"built {out} and {out}.zip\n"


@pytest.fixture
def differences(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[tuple[str, str]]]:
    """What is wrong with a bundle in itself and beside the record; how the record was asked."""
    found: dict[str, list[tuple[str, str]]] = {"itself": [], "record": [], "asked": []}

    def beside(_: Path, *, anew: bool, progress: object) -> list[tuple[str, str]]:
        found["asked"].append(("anew", str(anew and progress is not None)))
        return found["record"]

    monkeypatch.setattr(command, "verified", lambda _: found["itself"])
    monkeypatch.setattr(against_record, "differences", beside)
    return found


Differences = dict[str, list[tuple[str, str]]]


def test_a_sound_bundle_is_held_against_the_record(differences: Differences) -> None:
    shown = sunatlas("deposit", "verify", "a-bundle")
    assert (shown.exit_code, shown.stdout) == (0, "")
    assert shown.stderr == (
        "a-bundle: every checksum and every table holds, and is what the record makes\n"
    )
    assert sunatlas("deposit", "verify", "a-bundle", "--quick").exit_code == 0
    assert differences["asked"] == [("anew", "True"), ("anew", "False")]


def test_alone_it_is_said_what_cannot_be_seen(differences: Differences) -> None:
    differences["record"] = [("a.csv", "another number")]
    shown = sunatlas("deposit", "verify", "a-bundle", "--alone", "--format", "json")
    assert (shown.exit_code, json.loads(shown.stdout)) == (0, [])
    assert "it was held against itself alone\n" in shown.stderr
    assert shown.stderr.endswith(f"{UNSEEN}\n")
    assert differences["asked"] == []


@pytest.mark.parametrize("where", ["itself", "record"])
def test_a_difference_fails_with_its_file(differences: Differences, where: str) -> None:
    differences[where] = [("a.csv", "another number")]
    shown = sunatlas("deposit", "verify", "a-bundle", "--format", "json")
    assert shown.exit_code == 1
    assert json.loads(shown.stdout) == [{"file": "a.csv", "problem": "another number"}]
    assert len(differences["asked"]) == (where == "record"), "a damaged bundle is not compared"
    table = sunatlas("deposit", "verify", "a-bundle").stdout
    assert table.startswith("a-bundle: 1 problems\n")


SANDBOX = "https://sandbox.zenodo.org"
OTHER = "https://archive.example"
TOKEN = "not-a-secret"


@pytest.fixture
def uploaded(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """How an archive was asked to take a bundle; it leaves one file of the draft as it was."""
    asked: list[dict[str, Any]] = []
    for name in ("ZENODO_SANDBOX_TOKEN", "ZENODO_TOKEN", "ARCHIVE_TOKEN"):
        monkeypatch.setenv(name, TOKEN)
    done = Draft("7", "https://archive.example/7")

    def upload(
        archive: object,
        address: str,
        bundle: Path,
        *,
        version_of: str | None,
        draft: str | None,
        tell: Callable[[str, State], None],
    ) -> UploadResult:
        asked.append(
            {
                "kind": type(archive),
                "address": address,
                "bundle": bundle,
                "version_of": version_of,
                "draft": draft,
            }
        )
        tell("README.md", "sent")
        return UploadResult(done, {"README.md": "sent"}, ("notes.txt",))

    monkeypatch.setattr(uploading, "upload", upload)
    return asked


@pytest.mark.parametrize(
    ("options", "kind", "address", "then"),
    [
        ((), RecordsArchive, SANDBOX, ""),
        (("--api", "legacy"), DepositionsArchive, SANDBOX, " --api legacy"),
        (("--production",), RecordsArchive, "https://zenodo.org", " --production"),
        (("--server", OTHER), RecordsArchive, OTHER, f" --server {OTHER}"),
    ],
)
def test_an_upload_says_how_its_draft_is_published(
    uploaded: list[dict[str, Any]],
    options: tuple[str, ...],
    kind: type,
    address: str,
    then: str,
) -> None:
    shown = sunatlas("deposit", "upload", "--bundle", "b", "--draft", "7", *options)
    assert shown.exit_code == 0, shown.stderr
    assert uploaded == [
        {"kind": kind, "address": address, "bundle": Path("b"), "version_of": None, "draft": "7"}
    ]
    assert shown.stderr.splitlines() == [
        "sent: README.md",
        "left as it was, though not of the bundle: notes.txt",
        "draft 7: https://archive.example/7",
        "nothing is public; look at the draft, then: sunatlas deposit publish 7 --bundle b" + then,
    ]


def test_an_upload_in_json_is_not_public(uploaded: list[dict[str, Any]]) -> None:
    shown = sunatlas("deposit", "upload", "--new-version", "3", "--format", "json")
    assert json.loads(shown.stdout) == {
        "record": "7",
        "page": "https://archive.example/7",
        "published": False,
        "files": [{"file": "README.md", "state": "sent"}],
        "left": ["notes.txt"],
    }
    assert (uploaded[0]["version_of"], uploaded[0]["draft"]) == ("3", None)


@pytest.mark.parametrize(("doi", "then"), [("10.1234/7", ", DOI 10.1234/7"), (None, "")])
def test_what_is_published_is_named_by_its_page_and_doi(
    monkeypatch: pytest.MonkeyPatch, doi: str | None, then: str
) -> None:
    asked: list[tuple[type, str, Path]] = []

    def publish(archive: object, record: str, bundle: Path) -> PublishedRecord:
        asked.append((type(archive), record, bundle))
        return PublishedRecord(record, "https://archive.example/7", doi)

    monkeypatch.setenv("ZENODO_SANDBOX_TOKEN", TOKEN)
    monkeypatch.setattr(publishing, "publish", publish)
    shown = sunatlas("deposit", "publish", "7", "--bundle", "b", "--api", "legacy")
    assert shown.exit_code == 0, shown.stderr
    assert shown.stdout == f"published https://archive.example/7{then}\n"
    assert asked == [(DepositionsArchive, "7", Path("b"))]


# ---- dataset fetch


@pytest.mark.parametrize("out", [None, "elsewhere"])
def test_fetched_readings_are_named_with_whom_to_cite(
    monkeypatch: pytest.MonkeyPatch, out: str | None
) -> None:
    name, real = next(iter(SETS.items()))
    asked: list[tuple[object, Path]] = []

    def fetch(one: object, folder: Path) -> list[Path]:
        asked.append((one, folder))
        return [folder / "a.csv", folder / "LICENCE"]

    monkeypatch.setattr(fetching, "fetch", fetch)
    shown = sunatlas("dataset", "fetch", name, *(["--out", out] if out else []))
    assert shown.exit_code == 0, shown.stderr
    folder = out or name
    assert asked == [(real, Path(folder))]
    first, cited = shown.stdout.splitlines()
    assert first == f"wrote a.csv, LICENCE in {folder}"
    assert cited == f"cite: {real.citation}"
