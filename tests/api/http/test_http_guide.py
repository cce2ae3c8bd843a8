"""The guide over HTTP: its files, what is said where they are not, and nothing beside them."""

import pytest

from api.guide import site


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A site of two files, with one beside it that is not of it."""
    place = tmp_path / "site"
    (place / "models").mkdir(parents=True)
    (place / "index.html").write_text("<h1>The guide</h1>")
    (place / "models" / "lut.html").write_text("<h1>Tables</h1>" + "x" * 1000)
    (tmp_path / "beside.html").write_text("not of the site")
    (place / "out.html").symlink_to(tmp_path / "beside.html")
    monkeypatch.setattr(site, "cached_site", lambda: place)
    return place


def test_the_guide_is_served_below_its_own_address(atlas, place):
    sent = atlas.get("/guide?x=1")
    assert (sent.status_code, sent.headers["location"]) == (308, "/guide/?x=1")
    index = atlas.get("/guide/")
    assert (index.status_code, index.text) == (200, "<h1>The guide</h1>")
    assert index.headers["content-type"] == "text/html; charset=utf-8"
    assert "script-src 'self';" in index.headers["content-security-policy"]
    page = atlas.get("/guide/models/lut.html?highlight=table")
    assert page.status_code == 200
    again = atlas.get("/guide/models/lut.html", headers={"If-None-Match": page.headers["etag"]})
    assert again.status_code == 304


@pytest.mark.parametrize(
    "path", ["nothing.html", "models", "out.html", "%2e%2e/beside.html", "/etc/hostname", "%00"]
)
def test_only_files_of_the_site_are_served(atlas, place, path):
    answer = atlas.get(f"/guide/{path}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
    assert "a file of the guide" in answer.text or "a path" in answer.text


def test_until_it_is_built_a_page_says_how(atlas, tmp_path, monkeypatch):
    monkeypatch.setattr(site, "cached_site", lambda: tmp_path / "not-yet")
    answer = atlas.get("/guide/")
    assert answer.status_code == 503
    assert answer.headers["cache-control"] == "no-store"
    assert "sunatlas guide build" in answer.text


def test_where_it_cannot_be_built_a_page_says_how_to_install_it(atlas, monkeypatch):
    monkeypatch.setattr(site, "cached_site", lambda: None)
    answer = atlas.get("/guide/models/lut.html")
    assert answer.status_code == 503
    assert site.INSTALL in answer.text
