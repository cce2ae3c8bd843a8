"""/v1/datasets/{name}/errors and its files: what is published sample by sample."""

import io

import numpy as np
import pandas as pd
import pytest

from api.schema.samples import SampleError
from api.schema.table import columns_of
from api.server.app import create_app
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark.contract import Cell
from benchmark.results.samples import Directions, SampleErrors

NAME = "cmos-single-aperture"
SUN = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.8, 0.6]])
PIPELINES = [("bctm", "pinhole", 0), ("bctm", "pinhole", 3), ("weighted-spots", "pinhole", 0)]


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    directory = tmp_path_factory.mktemp("published")
    found = SampleErrors()
    found.directions[NAME] = Directions(SUN, np.array([True, True, False]), np.full(3, 0.0125))
    for k, (extractor, model, unit) in enumerate(PIPELINES):
        cell = Cell(NAME, "nominal", extractor, model, unit)
        found.add(cell, [0.25 + k, np.nan, np.nan], [True, True, False])
    found.write(directory, lambda _cell: True)
    return directory


@pytest.fixture(scope="module")
def client(published, client_of):
    return client_of(create_app(Knowledge(Measurements(published))))


def test_rows_are_those_of_the_file_with_their_directions(client):
    rows = client.get(f"/v1/datasets/{NAME}/errors").json()["items"]
    assert len(rows) == 9
    assert list(rows[0]) == list(columns_of(SampleError))
    assert rows[3] == {
        "extractor": "bctm",
        "model": "pinhole",
        "unit": 3,
        "sample": 0,
        "sun_x": 0.0,
        "sun_y": 0.0,
        "sun_z": 1.0,
        "observable": True,
        "bound_deg": 0.0125,
        "error_deg": 1.25,
        "outcome": 0,
    }
    assert [(row["error_deg"], row["outcome"]) for row in rows[:3]] == [
        (0.25, 0),
        (None, 2),
        (None, 1),
    ]
    table = client.table(f"/v1/datasets/{NAME}/errors")
    assert [row["error_deg"] for row in table[:3]] == ["0.25", "", ""]


@pytest.mark.parametrize("kind", ["errors", "directions"])
def test_the_file_is_the_published_one_and_pandas_reads_it(client, published, kind):
    name = NAME if kind == "errors" else f"{NAME}.directions"
    path = f"/v1/datasets/{NAME}/{kind}.parquet"
    answer = client.get(path, accept="*/*")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/vnd.apache.parquet"
    assert f'filename="{NAME}.{kind}.parquet"' in answer.headers["content-disposition"]
    assert answer.content == (published / "samples" / f"{name}.parquet").read_bytes()
    assert len(pd.read_parquet(io.BytesIO(answer.content))) == (9 if kind == "errors" else 3)
    again = client.get(path, accept="*/*", headers={"If-None-Match": answer.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_what_is_not_published_is_an_empty_list_and_no_file(client):
    assert client.get("/v1/datasets/ccd-slit/errors").json()["items"] == []
    answer = client.get("/v1/datasets/ccd-slit/errors.parquet", accept="*/*")
    assert answer.status_code == 404
    assert answer.json()["type"].endswith(":not-published")
