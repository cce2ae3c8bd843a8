"""Both editions of the studies, on every page, in every figure, endpoint, export and search."""

from __future__ import annotations

import pytest

from api.figures.catalogue import MATRIX
from registry.studies import facts
from tests.api.conftest import Client

LATER = "Herman2025c"


def later() -> list[str]:
    return [key for key, one in facts("all").studies.items() if one.edition == "extension"]


def test_every_later_study_has_its_page_and_its_endpoint_in_every_form(atlas: Client) -> None:
    assert len(later()) >= 10
    for key in later():
        page = atlas.get(f"/studies/{key}")
        assert page.status_code == 200
        assert "not mapped by the survey" in page.text
        after = facts("all").studies[key].year > 2024  # of the latest study that the survey maps
        assert ("after its latest study of 2024" in page.text) == after
        assert ("within its years, up to 2024" in page.text) != after
        for address in (f"/studies/{key}.json", f"/studies/{key}.csv", f"/v1/studies/{key}"):
            assert atlas.get(address).status_code == 200
        assert atlas.get(f"/v1/studies/{key}").json()["edition"] == "extension"
    assert "of the survey" in atlas.get("/studies/Chang2008").text


def test_the_survey_is_the_default_and_all_has_its_studies_first(atlas: Client) -> None:
    alone = atlas.walk("/v1/studies?limit=500")
    assert len(alone) == 129
    assert {study["edition"] for study in alone} == {"survey"}
    every = atlas.walk("/v1/studies?limit=500&edition=all")
    assert every[:129] == alone  # what runs of a study of the survey is not moved by others
    assert [study["key"] for study in every[129:]] == later()
    assert len(atlas.table("/v1/studies?limit=500&edition=all")) == len(every)


@pytest.mark.parametrize("chart", ["error"])
def test_flows_and_the_evidence_map_count_later_studies_only_where_asked(
    atlas: Client, chart: str
) -> None:
    for path in (f"/v1/flows/{chart}", f"/v1/figures/{MATRIX}"):
        alone = atlas.get(path).json()["studies"]
        every = atlas.get(f"{path}?edition=all").json()["studies"]
        assert (alone, every) == (129, 129 + len(later()))
    keys = {
        key for row in atlas.get(f"/v1/flows/{chart}").json()["nodes"] for key in row["studies"]
    }
    assert not keys & set(later())


def test_the_page_of_figures_counts_the_studies_that_they_may_add(atlas: Client) -> None:
    assert f"can include {len(later())} studies that the survey" in atlas.get("/figures").text


def test_a_recommendation_names_later_studies_only_where_asked(atlas: Client) -> None:
    def keys(edition: str) -> set[str]:
        document = atlas.get(f"/v1/recommendations/flow?edition={edition}").json()
        return {key for path in document["paths"] for key in path["studies"]}

    assert not keys("survey") & set(later())
    assert keys("all") >= keys("survey")
    assert keys("all") & set(later())


def test_sensors_and_comparisons_have_later_studies_only_where_asked(atlas: Client) -> None:
    known = facts("all").studies
    key, (detector, mask) = next((k, p) for k in later() for p in known[k].architectures)
    compared = f"compare.json?architecture={detector}:{mask}&architecture=CMOS:Encoded"
    for address in (
        f"/detectors/{detector}.json",
        f"/masks/{mask}.json",
        f"/architectures/{detector}/{mask}.json",
        f"/{compared}",
        f"/v1/{compared.replace('.json', '')}",
    ):
        more = f"{'&' if '?' in address else '?'}edition=all"
        assert f'"{key}"' not in atlas.get(address).text, address
        assert f'"{key}"' in atlas.get(address + more).text, address
    page = f"/detectors/{detector}"
    assert f'href="{page}?edition=all"' in atlas.get(page).text
    assert f"/studies/{key}" in atlas.get(f"{page}?edition=all").text


def test_what_is_only_the_nearest_is_neither_stated_nor_complete(atlas: Client) -> None:
    document = atlas.get(f"/v1/studies/{LATER}").json()
    cell = next(each for each in document["attributes"] if each["attribute"] == "model")
    assert cell["nearest"]
    assert "sparse" in cell["name_in_study"]
    assert document["state"] != "complete"
    assert "model" in {gap["attribute"] for gap in document["gaps"]}
    assert {pipeline["basis"]["model"] for pipeline in document["pipelines"]} == {"defaulted"}
