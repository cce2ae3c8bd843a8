"""The API reference: every operation of the OpenAPI document, no script, nothing from elsewhere."""

import re
from html.parser import HTMLParser

import pytest

from api.http.openapi_sharing import inlined


class Page(HTMLParser):
    """Links, ids, elements and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.ids, self.tags, self.words = [], [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.tags.add(tag)
        if "href" in given:
            self.links.append(given["href"])
        if "id" in given:
            self.ids.append(given["id"])
        assert "src" not in given

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def page(atlas):
    answer = atlas.get("/docs")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert atlas.get("/docs", headers={"If-None-Match": answer.headers["etag"]}).status_code == 304
    return Page(answer.text)


def test_every_operation_and_parameter_is_told(atlas, page):
    text = " ".join(page.words)
    for path, item in inlined(atlas.get("/openapi.json").json()).items():
        for method, operation in item.items():
            assert f"{method.upper()} {path}" in text
            assert operation["operationId"] in page.ids
            for parameter in operation.get("parameters", ()):
                assert parameter["name"] in page.words


def test_the_columns_of_every_table_are_listed(atlas, page):
    text = " ".join(page.words)
    for path in ("/v1/results", "/v1/advice"):
        header = atlas.get(f"{path}?format=csv&limit=1").text.partition("\n")[0]
        assert f"Columns: {header.replace(',', ', ')}." in text


def test_it_needs_no_script_and_no_other_server(page):
    assert "script" not in page.tags
    assert not [link for link in page.links if re.match(r"(?:https?:)?//", link)]
    inside = [link[1:] for link in page.links if link.startswith("#")]
    assert sorted(inside) == sorted(page.ids)


def test_its_examples_are_answered(atlas, page):
    examples = [link for link in page.links if link.startswith("/v1/")]
    assert len(examples) > 20
    for link in examples:
        assert atlas.get(link).status_code == 200, link
