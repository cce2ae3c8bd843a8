"""Files for operators name what there is: options of the command, files of the repository."""

import configparser
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from api.cli.command_line import load
from api.service import calibrations
from api.web import requests
from calibrate.uploaded import LONGEST_S

ROOT = Path(__file__).resolve().parents[3]
UNIT = ROOT / "deploy" / "sunatlas.service"
CONTAINER = (ROOT / "deploy" / "Containerfile").read_text()


def unit():
    read = configparser.ConfigParser(strict=False, interpolation=None)
    read.optionxform = str
    read.read_string(UNIT.read_text())
    return read


def commands():
    yield shlex.split(unit()["Service"]["ExecStart"])
    yield json.loads(re.findall(r"^CMD (\[.*\])$", CONTAINER, re.MULTILINE)[-1])


@pytest.mark.parametrize("command", list(commands()), ids=["unit", "container"])
def test_the_command_is_understood(command):
    assert command[0].endswith("sunatlas")
    assert command[1] == "serve"
    context = load("serve").make_context("serve", command[2:])
    assert context.params["workers"] == 2
    assert context.params["access_log"] is True


def test_the_proxy_lets_through_what_the_service_takes_in_the_time_it_has():
    text = (ROOT / "deploy" / "Caddyfile").read_text()
    (size,) = re.findall(r"max_size ([\d.]+)MB", text)
    assert float(size) * 1e6 == requests.LARGEST_FORM
    minutes = dict(re.findall(r"(read_body|write|response_header_timeout) (\d+)m", text))
    slowest_s = requests.PATIENCE_S + requests.LARGEST_FORM / requests.SLOWEST_PER_S
    turn_s = (calibrations.MOST_WAITING + 1) * LONGEST_S  # of who waits for all others
    assert float(minutes["read_body"]) * 60 > slowest_s
    assert float(minutes["response_header_timeout"]) * 60 > turn_s
    assert float(minutes["write"]) * 60 > slowest_s + turn_s


def copied():
    """Yield what the container copies, by its name here and in the container."""
    for line in re.findall(r"^COPY (?!--)(.*)$", CONTAINER, re.MULTILINE):
        *names, target = line.split()
        for name in names:
            yield name, name if target == "./" else target


def test_the_container_copies_what_the_package_is_made_of():
    names = {name for name, _ in copied()}
    assert all((ROOT / name).exists() for name in names)
    read = tomllib.loads((ROOT / "pyproject.toml").read_text())
    wheel = read["tool"]["hatch"]["build"]["targets"]["wheel"]
    made_of = {*wheel["packages"], *wheel["force-include"], read["project"]["readme"]}
    made_of |= {name.split("/")[0] for name in read["project"]["license-files"]}
    assert made_of <= names
    assert re.search(r"^USER \d+$", CONTAINER, re.MULTILINE)


def test_both_stages_begin_with_one_image_that_cannot_be_exchanged():
    begun = re.findall(r"^FROM (\S+)", CONTAINER, re.MULTILINE)
    assert len(begun) == 2
    assert len(set(begun)) == 1
    assert re.fullmatch(r"\S+@sha256:[0-9a-f]{64}", begun[0])


#: What a container answers, asked of its packages alone: pages, the guide's, and who it is.
_ASKED = """
import api, sys
from pathlib import Path
from fastapi.testclient import TestClient
from api.metadata.identity import identity
from api.guide import site
from api.server.app import create_app
assert Path(api.__file__).is_relative_to(sys.argv[1]), api.__file__
assert site.source().is_relative_to(sys.argv[1]), site.source()
assert (site.source() / "http.md").is_file()
assert identity().citation == Path(sys.argv[2]).read_text("utf-8")
assert identity().code_licence and identity().data_licence
client = TestClient(create_app())
for address in ("/", "/figures", "/algorithms/tm", "/datasets", "/claims/C04", "/glossary", "/docs",
                "/v1/recommendations?limit=1", "/v1/studies", "/healthz", "/page/page.js"):
    assert client.get(address, headers={"Accept": "*/*"}).status_code == 200, address
print("served")
"""


@pytest.mark.slow
def test_what_the_container_copies_builds_and_serves_with_nothing_beside(tmp_path):
    """The wheel of these files alone, away from the checkout, has all that the service reads."""
    source, installed, elsewhere = (tmp_path / n for n in ("source", "installed", "elsewhere"))
    for folder in (source, installed, elsewhere):
        folder.mkdir()
    for name, target in copied():
        if (ROOT / name).is_dir():
            skipped = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / name, source / target, ignore=skipped)
        else:
            shutil.copy(ROOT / name, source / target)
    build = [
        sys.executable,
        "-m",
        "hatchling",
        "build",
        "--target",
        "wheel",
        "--directory",
        tmp_path,
    ]
    subprocess.run(build, cwd=source, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(installed)
    shutil.rmtree(source)
    asked = [sys.executable, "-P", "-c", _ASKED, installed, ROOT / "CITATION.cff"]
    run = subprocess.run(
        asked,
        cwd=elsewhere,
        env={**os.environ, "PYTHONPATH": str(installed), "SUNATLAS_STORE": str(tmp_path / "store")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stdout.strip() == "served", run.stderr[-2000:]
