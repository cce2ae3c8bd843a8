"""Errors sample by sample lie in the bundle as published, described and with checksums."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import yaml

from api.deposit.bundle import build
from api.deposit.verification import verify
from benchmark.contract import Cell
from benchmark.results.samples import Directions, SampleErrors
from benchmark.results.store import PUBLISHED
from files.manifest import manifest_digest

NAME = "ccd-lens"


@pytest.mark.slow
def test_a_bundle_has_the_errors_of_its_record_and_holds(tmp_path):
    published = tmp_path / "published"
    shutil.copytree(PUBLISHED, published)
    found = SampleErrors()
    found.directions[NAME] = Directions(np.eye(3)[:2], np.ones(2, bool), np.full(2, 0.5))
    only = Cell(NAME, "nominal", "bctm", "pinhole")
    found.add(only, [0.25, np.nan], [True, False])
    found.write(published, lambda cell: cell == only)
    bundle = build(tmp_path / "bundle", published=published, frames=[]).directory
    assert verify(bundle) == []
    resources = json.loads((bundle / "datapackage.json").read_text("utf-8"))["resources"]
    crate = json.loads((bundle / "ro-crate-metadata.json").read_text("utf-8"))["@graph"]
    for kind, name in (("errors", NAME), ("directions", f"{NAME}.directions")):
        path = f"benchmark/samples/{name}.parquet"
        assert (bundle / path).read_bytes() == (
            published / "samples" / f"{name}.parquet"
        ).read_bytes()
        (resource,) = [r for r in resources if r["path"] == path]
        assert resource["name"] == f"{kind}-{NAME}"
        (entity,) = [e for e in crate if e["@id"] == path]
        assert entity["encodingFormat"] == "application/vnd.apache.parquet"
        assert path in (bundle / "checksums-sha256.txt").read_text("utf-8")
    assert pd.read_parquet(bundle / f"benchmark/samples/{NAME}.parquet")["error_deg"][0] == 0.25
    cited = yaml.safe_load((bundle / "CITATION.cff").read_text("utf-8"))["identifiers"]
    assert f"sha256:{manifest_digest(published)}" in [identifier["value"] for identifier in cited]
