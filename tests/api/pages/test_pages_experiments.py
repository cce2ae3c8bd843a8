"""A new experiment is one file: it is planned, measured, recorded, drawn and on a page."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from fastapi import FastAPI

from api.server.app import create_app
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark import experiments as package
from benchmark.experiments.__main__ import main
from benchmark.results.store import PUBLISHED
from tests.api.conftest import Client

MODULE = '''
"""Powers of small numbers."""

from collections.abc import Callable, Mapping, Sequence

from pydantic import BaseModel

from benchmark.plot_style import svg
from benchmark.results.row_file import Row, RowFile
from benchmark.running.experiment import RecordedExperiment


class CubeRow(BaseModel, extra="forbid"):
    cell: str
    cube: int
    parts: list[int]
    key: str


class Cubes(RecordedExperiment[str]):
    """A row of each number, with its cube."""

    name = "cubes"
    title = "Cubes of numbers"
    record = RowFile("cubes.json", "cubes", 1, lambda row: row["cell"], CubeRow)

    def keys(self) -> Mapping[str, str]:
        return dict.fromkeys("234", "made up")

    def tasks(self, cells: Sequence[str]) -> Sequence[str]:
        return cells

    @staticmethod
    def measure(task: str) -> list[tuple[str, Row]]:
        return [(task, {"cell": task, "cube": int(task) ** 3, "parts": [int(task)] * 3})]

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        return {"cubes.svg": lambda: svg(self._figure, "Cubes")}

    def _figure(self):
        from matplotlib.figure import Figure

        drawn = Figure()
        drawn.subplots().plot([row["cube"] for row in self.rows()])
        return drawn
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a made-up experiment, which is found beside the others."""
    (tmp_path / "cubes.py").write_text(MODULE)
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
    yield tmp_path
    sys.modules.pop("benchmark.experiments.cubes", None)
    vars(package).pop("cubes", None)


def test_one_file_is_a_whole_experiment(
    folder: Path, client_of: Callable[[FastAPI], Client], capsys: pytest.CaptureFixture[str]
) -> None:
    record = folder / "record"
    command = ["cubes", "--directory", str(record)]
    assert main([*command, "--check"]) == 1
    assert capsys.readouterr().out.splitlines() == [f"cubes {n}: absent" for n in (2, 3, 4)]
    assert main(command) == 0
    assert main([*command, "--check"]) == 0
    assert main([*command, "--again", "2"]) == 0
    assert '"cube":27' in (record / "cubes.json").read_text()
    client = client_of(create_app(Knowledge(Measurements(record))))
    listed = client.get("/experiments.json").json()["items"]
    assert {"name": "cubes", "title": "Cubes of numbers"}.items() <= listed[-1].items()
    page = client.get("/experiments/cubes", accept="text/html")
    described = MODULE.partition("class Cubes")[2].split('"""')[1]
    assert described in page.text
    assert "/experiments/cubes/cubes.svg" in page.text
    assert client.get("/experiments/cubes.csv").text == "cell,cube\n2,8\n3,27\n4,64\n"
    items = client.get("/experiments/cubes.json").json()["items"]
    assert items[0] == {"cell": "2", "cube": 8, "parts": [2, 2, 2]}
    assert "<title>Cubes" in client.get("/experiments/cubes/cubes.svg").text
    assert client.get("/experiments/cubes/none.svg").status_code == 404
    assert client.get("/experiments/none").status_code == 404


def test_every_laser_of_the_record_is_in_the_json_and_a_row_of_the_csv(atlas: Client) -> None:
    sensors = json.loads((PUBLISHED / "spoofing.json").read_text("utf-8"))["sensors"]
    items = atlas.get("/experiments/spoofing.json").json()["items"]
    assert [one["levels"] for one in items] == [one["levels"] for one in sensors]
    assert [one["rises"] for one in items] == [one["rises"] for one in sensors]
    counts = ("readings", "answered", "flagged", "deceived", "turned")
    lasers = [
        (
            *(of["dataset"], of["extractor"], str(at["sun"]).lower(), str(at["suns"])),
            *(str(at[name]) for name in counts),
            *(str(at["noticed"]["pattern"]), str(at["curve"][0]), str(of["alarms"]["pattern"])),
        )
        for of in sensors
        for at in of["levels"]
    ]
    names = ("dataset", "extractor", "sun", "suns", *counts, "noticed_pattern")
    names += ("noticed_pattern_at_0.1", "checking_alarms_pattern")
    table = atlas.table("/experiments/spoofing")
    assert [tuple(row[name] for name in names) for row in table] == lasers
    page = atlas.get("/experiments/spoofing", accept="text/html").text
    assert f"{len(lasers)} rows." in page


@pytest.mark.parametrize(
    ("file", "shown"),
    [
        ("spoofing.svg", "that believe it and that notice it"),
        ("spoofing-roc.svg", "that the pattern's residual notices"),
    ],
)
def test_each_picture_of_lasers_has_the_title_of_what_it_shows(
    file: str, shown: str, atlas: Client
) -> None:
    drawn = ET.fromstring(atlas.get(f"/experiments/spoofing/{file}").content)
    title = drawn.findtext("{http://www.w3.org/2000/svg}title")
    assert title is not None
    assert title.endswith(shown)
    assert title in [text.text for text in drawn.iter("{http://www.w3.org/2000/svg}text")]
