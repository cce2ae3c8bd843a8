"""What machines find: Croissant, schema.org, Signposting, by the libraries that read them.

Those are imported where they are used: seconds for a worker that has none of these tests.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterator
from typing import Any

import pytest

from api.metadata.signposting import landing_of_study
from benchmark import datasets

PAGES = {
    "/": {"DataCatalog", "SoftwareApplication"},
    "/studies/Chang2008": {"ScholarlyArticle"},
    "/datasets/pd-slit": {"Dataset"},
    "/datasets/cmos-single-aperture?condition=albedo": {"Dataset"},
    "/algorithms/bctm": {"SoftwareSourceCode"},
    "/leaderboard": {"Dataset"},
}
#: mlcroissant still uses what rdflib and pandas call deprecated.
pytestmark = pytest.mark.filterwarnings("ignore::Warning:mlcroissant", "ignore::Warning:rdflib")
DATASETS = ("pd-slit", "cmos-single-aperture")


@pytest.fixture(scope="module")
def address(atlas, serve) -> Iterator[str]:
    """The service on a port."""
    with serve(atlas.app) as connection:
        yield f"http://{connection.host}:{connection.port}"


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load a Croissant document; it has no errors and no warnings, files come anew."""
    import mlcroissant

    monkeypatch.setattr(mlcroissant._src.core.constants, "DOWNLOAD_PATH", tmp_path)

    def loaded(jsonld: Any) -> Any:
        found = mlcroissant.Dataset(jsonld=jsonld)
        issues = found.metadata.ctx.issues
        assert (issues.errors, issues.warnings) == (set(), set())
        return found

    return loaded


def rows_of(dataset: Any, table: str) -> list[dict[str, Any]]:
    found = dataset.records(record_set=table)
    return [{k.removeprefix(f"{table}/"): v for k, v in row.items()} for row in found]


@pytest.mark.parametrize("name", DATASETS)
def test_croissant_loads_what_is_served_of_a_data_set(atlas, address, load, name) -> None:
    dataset = load(f"{address}/v1/datasets/{name}/croissant.json")
    directions = rows_of(dataset, "directions")
    published = atlas.app.state.knowledge.measurements.sample_errors(name)
    assert len(directions) == published["sample"].nunique()
    row = directions[7]
    known = published[published["sample"] == row["sample"]].iloc[0]
    assert [type(row[n]) for n in ("sample", "sun_x", "observable")] == [int, float, bool]
    assert [row[f"sun_{axis}"] for axis in "xyz"] == [float(known[f"sun_{axis}"]) for axis in "xyz"]
    assert math.hypot(*(row[f"sun_{axis}"] for axis in "xyz")) == pytest.approx(1.0, abs=1e-6)
    splits = rows_of(dataset, "splits")
    rows = atlas.get(f"/v1/datasets/{name}").json()["data"]
    texts = ("condition", "split", "data_hash")
    rows = [{k: v.encode() if k in texts and v else v for k, v in row.items()} for row in rows]
    assert splits == rows


@pytest.mark.parametrize("step", [13, pytest.param(1, marks=pytest.mark.slow)])
def test_data_sets_have_valid_croissant_with_digests_of_what_is_served(atlas, load, step) -> None:
    for name in datasets.names()[::step]:
        answer = atlas.get(f"/v1/datasets/{name}/croissant.json")
        assert answer.headers["content-type"] == "application/ld+json"
        document = answer.json()
        load(document)
        assert len(document["distribution"]) == 3
        for file in document["distribution"]:
            served = atlas.get(file["contentUrl"].removeprefix("http://atlas.test"))
            assert hashlib.sha256(served.content).hexdigest() == file["sha256"]
            assert served.headers["content-type"].partition(";")[0] in file["encodingFormat"]


def test_addresses_in_a_document_are_those_of_who_is_asked(atlas) -> None:
    path = "/v1/datasets/pd-slit/croissant.json"
    here = atlas.get(path)
    there = atlas.get(path, headers={"Host": "sun.example"})
    assert here.json()["url"] == "http://atlas.test/datasets/pd-slit"
    assert there.json()["url"] == "http://sun.example/datasets/pd-slit"
    assert here.headers["etag"] != there.headers["etag"]
    assert atlas.get(path).content == here.content
    assert atlas.get(path, accept="application/json").json() == here.json()
    assert atlas.get(path, accept="text/csv").status_code == 406
    assert atlas.get("/v1/datasets/pd-slitt/croissant.json").status_code == 404


def entity_of(page: str) -> dict[str, Any]:
    (found,) = re.findall(r'<script type="application/ld\+json">(.*?)</script>', page, re.DOTALL)
    return json.loads(found)


def entities(value: Any) -> Iterator[dict[str, Any]]:
    """Give every typed object in a document."""
    if isinstance(value, list):
        for member in value:
            yield from entities(member)
    elif isinstance(value, dict):
        if "@type" in value:
            yield value
        for member in value.values():
            yield from entities(member)


@pytest.mark.parametrize("path", PAGES)
def test_a_page_says_what_it_is_about_in_the_words_of_schema_org(atlas, path) -> None:
    import msgspec_schemaorg.models as schema_org
    import rdflib

    document = entity_of(atlas.get(path, accept="text/html").text)
    assert document["@context"] == "https://schema.org"
    main = document.get("@graph", [document])
    assert {entity["@type"] for entity in main} == PAGES[path]
    count = 0
    for entity in entities(document):
        known = getattr(schema_org, entity["@type"])
        left = set(entity) - set(known.__struct_encode_fields__)
        assert not left, f"{entity['@type']} has no {left}"
        count += 1
    # As RDF: nothing is lost, and relative addresses are those of the page.
    text = json.dumps({**document, "@context": {"@vocab": "https://schema.org/"}})
    graph = rdflib.Graph().parse(data=text, format="json-ld", publicID=f"http://atlas.test{path}")
    assert len(set(graph.subjects(rdflib.RDF.type))) >= len(main)
    names = {str(name) for name in graph.subjects() if isinstance(name, rdflib.URIRef)}
    assert all(name.startswith("http://atlas.test/") for name in names)
    assert count >= len(main)


def test_text_of_a_page_s_entity_cannot_end_its_script() -> None:
    from api.metadata.schema_org import study
    from api.pages.rendering import environment

    row = {"key": "A", "title": "</script><b>", "authors": "", "year": None, "venue": "", "doi": ""}
    entity = study(row, landing_of_study("A", None))
    shown = environment().from_string("{{ entity|tojson }}").render(entity=entity)
    assert "</" not in shown
    assert json.loads(shown)["name"] == "</script><b>"
    assert set(entity) == {"@context", "@type", "@id", "url", "alternateName", "name", "headline"}


@pytest.mark.parametrize("step", [13, pytest.param(1, marks=pytest.mark.slow)])
def test_every_study_s_entity_says_what_is_known(atlas, step: int) -> None:
    from signposting import find_signposting_http_link

    for item in atlas.walk("/v1/studies?limit=50")[::step]:
        page = atlas.get(f"/studies/{item['key']}", accept="text/html")
        entity = entity_of(page.text)
        assert entity["alternateName"] == item["key"]
        assert entity.get("name") == (item["title"] or None)
        doi = f"https://doi.org/{item['doi']}" if item["doi"] else None
        assert entity.get("sameAs") == doi
        cited = find_signposting_http_link([page.headers["link"]], str(page.url)).citeAs
        assert (cited and str(cited.target)) == doi


def test_signposts_lead_from_the_page_to_its_parts_and_back(address) -> None:
    from signposting import find_signposting_http

    page = find_signposting_http(f"{address}/datasets/pd-slit")
    assert {str(t.target) for t in page.types} == {
        "https://schema.org/AboutPage",
        "https://schema.org/Dataset",
    }
    assert str(page.license.target) == "https://spdx.org/licenses/MIT"
    assert len(page.items) == 3
    for item in page.items:
        content = find_signposting_http(str(item.target))
        assert str(content.collection.target) == f"{address}/datasets/pd-slit"
        assert content.license == page.license or content.license.target == page.license.target
    profiles = set()
    for about in page.describedBy:
        described = find_signposting_http(str(about.target))
        back = [s for s in described.signposts if s.rel.value == "describes"]
        assert [str(s.target) for s in back] == [f"{address}/datasets/pd-slit"]
        profiles |= {str(p) for p in about.profiles}
    assert "http://mlcommons.org/croissant/1.0" in profiles
