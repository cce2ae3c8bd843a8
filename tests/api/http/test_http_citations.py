"""References over HTTP: by `format`, by Accept, of any selection, read by other programs."""

import json

import bibtexparser
import pytest
import rispy

FORMS = {
    "bibtex": "application/x-bibtex",
    "ris": "application/x-research-info-systems",
    "csl": "application/vnd.citationstyles.csl+json",
}


def keys(form, text):
    if form == "bibtex":
        library = bibtexparser.parse_string(text)
        assert library.failed_blocks == []
        return {entry.key for entry in library.entries}
    if form == "ris":
        return {entry["id"] for entry in rispy.loads(text)}
    return {item["id"] for item in json.loads(text)}


@pytest.mark.parametrize("form", FORMS)
def test_a_selection_is_cited_by_format_and_by_accept_alike(atlas, form):
    url = "/v1/studies?detector=CMOS&mask=Encoded"
    found = atlas.get(url).json()["items"]
    titled = {study["key"] for study in found if study["title"]}
    assert titled
    named = atlas.get(f"{url}&format={form}")
    assert named.status_code == 200
    assert named.headers["content-type"].partition(";")[0] == FORMS[form]
    assert named.headers["content-disposition"].startswith('attachment; filename="studies.')
    assert keys(form, named.text) == titled
    assert atlas.get(url, accept=FORMS[form]).content == named.content


def test_keys_select_studies(atlas):
    found = atlas.get("/v1/studies?key=Liebe2002&key=Wei2013&detector=CMOS").json()["items"]
    assert {study["key"] for study in found} <= {"Liebe2002", "Wei2013"}
    refused = atlas.get("/v1/studies?key=Liebe2003")
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["parameter"] == "key"


def test_references_have_no_columns(atlas):
    refused = atlas.get("/v1/studies?fields=key&format=ris")
    assert refused.status_code == 400
    assert refused.json()["errors"][0]["parameter"] == "fields"
