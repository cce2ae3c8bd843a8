"""ETags, conditional requests, HEAD and gzip: the bytes are the same however they come."""

import gzip

import pytest

from api.web.static_files import page_address

PATHS = [
    "/v1/taxonomy",
    "/v1/studies/Chang2008",
    "/v1/flows/error",
    "/figures/models.svg",
    "/v1/recommendations?task=Accuracy",
    "/v1/leaderboard",
    "/openapi.json",
    "/",
    "/studies/Chang2008",
    "/page/page.js",
]
PLAIN = {"Accept-Encoding": "identity"}
GZIP = {"Accept-Encoding": "gzip"}


@pytest.mark.parametrize("path", PATHS)
def test_bytes_known_by_their_etag_are_not_sent_again(atlas, path):
    whole = atlas.get(path, headers=PLAIN)
    etag = whole.headers["etag"]
    assert whole.status_code == 200
    assert not etag.startswith("W/")
    for header in (etag, f"W/{etag}", f'"other", {etag}', "*"):
        answer = atlas.get(path, headers={**PLAIN, "If-None-Match": header})
        assert answer.status_code == 304, header
        assert answer.content == b""
        assert answer.headers["etag"] == etag
        assert answer.headers["vary"] == whole.headers["vary"]
        assert "content-type" not in answer.headers
    answer = atlas.get(path, headers={**PLAIN, "If-None-Match": '"other"'})
    assert answer.content == whole.content


def raw_body(atlas, path, headers):
    """The body as it travels, without the client decoding it."""

    async def read():
        async with atlas._client.stream("GET", path, headers=headers) as response:
            return response, b"".join([chunk async for chunk in response.aiter_raw()])

    return atlas._runner.run(read())


@pytest.mark.parametrize("path", PATHS)
def test_gzip_carries_the_same_bytes_under_another_etag(atlas, path):
    plain, body = raw_body(atlas, path, PLAIN)
    assert "content-encoding" not in plain.headers
    zipped, compressed = raw_body(atlas, path, GZIP)
    if len(body) < 512:
        assert compressed == body
        return
    assert zipped.headers["content-encoding"] == "gzip"
    assert int(zipped.headers["content-length"]) == len(compressed) < len(body)
    assert gzip.decompress(compressed) == body
    assert zipped.headers["etag"] != plain.headers["etag"]
    assert "Accept-Encoding" in zipped.headers["vary"]


@pytest.mark.parametrize("refused", ["gzip;q=0", ""])
def test_who_refuses_gzip_is_not_sent_it_whoever_asked_before(atlas, refused):
    raw_body(atlas, "/v1/taxonomy", {"Accept-Encoding": "gzip"})
    plain, body = raw_body(atlas, "/v1/taxonomy", {"Accept-Encoding": refused})
    assert "content-encoding" not in plain.headers
    assert body.startswith(b"{")


def test_files_of_the_page_below_their_digest_may_be_kept_and_others_not(atlas):
    for name in ("page.js", "styles.css", "theme.js"):
        assert "immutable" in atlas.get(f"{page_address()}/{name}").headers["cache-control"]
    assert atlas.get("/page/page.js").headers["cache-control"] == "no-cache"
    assert atlas.get("/page/0123456789ab/page.js").status_code == 404


@pytest.mark.parametrize("path", [p for p in PATHS if p != "/"])
def test_head_is_get_without_a_body(atlas, path):
    get = atlas.get(path, headers=PLAIN)
    head = atlas.request("HEAD", path, headers=PLAIN)
    assert head.status_code == 200
    assert head.content == b""
    assert dict(head.headers) == dict(get.headers)


def test_the_same_question_spelt_otherwise_has_the_same_answer(atlas):
    one = atlas.get("/v1/recommendations?task=Accuracy&task=FOV&max_error_deg=1")
    two = atlas.get("/v1/recommendations?max_error_deg=1.0&task=FOV&task=Accuracy&task=FOV")
    three = atlas.post(
        "/v1/recommendations", json={"max_error_deg": 1, "task": ["FOV", "Accuracy"]}
    )
    assert one.content == two.content == three.content
    assert one.headers["etag"] == two.headers["etag"] == three.headers["etag"]


def test_every_answer_keeps_the_page_to_itself(atlas):
    for path in ("/", "/v1/taxonomy", "/healthz", "/page/page.js"):
        headers = atlas.get(path).headers
        assert headers["x-content-type-options"] == "nosniff"
        policy = dict(part.split(" ", 1) for part in headers["content-security-policy"].split("; "))
        assert policy["default-src"] == "'none'"
        assert policy["script-src"] == "'self'"
        assert policy["connect-src"] == "'self'"
        assert "http" not in headers["content-security-policy"]


def test_representations_have_different_etags(atlas):
    json_etag = atlas.get("/v1/studies").headers["etag"]
    csv_etag = atlas.get("/v1/studies", accept="text/csv").headers["etag"]
    assert json_etag != csv_etag
    assert "Accept" in atlas.get("/v1/studies").headers["vary"].split(", ")
