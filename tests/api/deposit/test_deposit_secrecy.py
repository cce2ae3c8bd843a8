"""The token: to the one server it is for, in one header, and nowhere else."""

import logging
import pickle
import re

import httpx
import pytest

from api.deposit.archives.contract import ArchiveError
from api.deposit.archives.server import (
    SANDBOX,
    ZENODO,
    ServerError,
    Token,
    server_at,
    token_of,
)
from api.deposit.archives.transport import Transport
from tests.api.deposit.conftest import each, only
from tests.api.deposit.standins.records import Records
from tests.api.deposit.standins.server import TOKEN, StandIn


class Elsewhere(StandIn):
    """Somebody else's server, that only notes who came."""

    def answer(self, method, path, kind, body):
        return 200, {}


@each("create", "list", "send", "commit", "version", "import")
def test_a_redirect_is_not_followed(journey, step):
    first = journey.upload().draft.id if step in {"version", "import"} else None
    if first:
        journey.publish(first)
    with Elsewhere() as other:
        journey.fails("redirect", step, Location=f"{other.address}/api/records")
        with pytest.raises(ArchiveError, match="redirects are not followed"):
            journey.upload(version_of=first)
        assert other.asked == []


@only("legacy")
def test_an_address_elsewhere_is_not_asked(journey):
    with Elsewhere() as other:
        journey.archive.bucket_at = other.address
        with pytest.raises(ArchiveError, match=re.escape(other.address)):
            journey.upload()
        assert other.asked == []


@pytest.mark.parametrize(
    "where",
    [
        "http://127.0.0.1:1.evil.example/x",
        "https://127.0.0.1:1/x",
        "http://127.0.0.1:12/x",
        "http://me@127.0.0.1:1/x",
    ],
)
def test_an_address_that_looks_alike_is_elsewhere(where):
    with (
        Transport(server_at("http://127.0.0.1:1"), Token(TOKEN)) as transport,
        pytest.raises(ArchiveError, match="no other host"),
    ):
        transport.tell("GET", where)


@pytest.mark.parametrize("kind", [400, 401, 403, 409, 413])
@each("create", "send")
def test_a_server_that_says_the_token_back_is_not_quoted(journey, caplog, kind, step):
    caplog.set_level(logging.DEBUG)
    journey.fails(kind, step)
    with pytest.raises(ArchiveError) as refused:
        journey.upload()
    assert "you sent Bearer ***" in str(refused.value)
    assert TOKEN not in repr(refused.value)
    assert TOKEN not in caplog.text
    assert caplog.records, "the libraries beneath do log"


def test_nothing_written_holds_the_token(journey):
    journey.upload()
    found = [path for path in journey.bundle.parent.rglob("*") if path.is_file()]
    assert len(found) > 5
    assert not [path for path in found if TOKEN.encode() in path.read_bytes()]
    signed = {a.headers["Authorization"] for a in journey.archive.asked}
    assert signed == {f"Bearer {TOKEN}"}
    assert not [a for a in journey.archive.asked if TOKEN in a.path]


def test_a_token_has_no_text_and_is_not_stored():
    token = Token(TOKEN)
    assert TOKEN not in f"{token} {token!r}"
    with pytest.raises(TypeError, match="not stored"):
        pickle.dumps(token)


def test_each_server_has_a_token_of_its_own(monkeypatch):
    for name in ("ZENODO_TOKEN", "ZENODO_SANDBOX_TOKEN", "ARCHIVE_TOKEN"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ZENODO_TOKEN", TOKEN)
    assert token_of(ZENODO).header == f"Bearer {TOKEN}"
    for server in (SANDBOX, server_at("https://archive.example")):
        with pytest.raises(ServerError, match=server.variable):
            token_of(server)


@pytest.mark.parametrize("text", ["two words here", "line\nbreak-in-it", "short", "ünicode-token"])
def test_what_is_no_token_is_refused_unsaid(monkeypatch, text):
    monkeypatch.setenv("ZENODO_SANDBOX_TOKEN", text)
    with pytest.raises(ServerError, match="holds no token") as refused:
        token_of(SANDBOX)
    assert text not in str(refused.value)


@pytest.mark.parametrize(
    "address",
    [
        "http://zenodo.org",
        "ftp://zenodo.org",
        "zenodo.org",
        "https://me:secret@zenodo.org",
        "https://zenodo.org/api",
        "https://",
        "",
        "http://127.0.0.1.evil.example",
    ],
)
def test_what_is_no_safe_address_is_refused(address):
    with pytest.raises(ServerError, match="no address of an archive"):
        server_at(address)


def test_known_addresses_keep_their_tokens():
    assert server_at("https://zenodo.org/") == ZENODO
    assert server_at("https://sandbox.zenodo.org") == SANDBOX


def test_the_stand_in_refuses_strangers():
    """The oracle's own door: a wrong token, no name, a call that no documentation knows."""
    with Records() as archive, httpx.Client(base_url=archive.address, trust_env=False) as client:
        named = {"User-Agent": "sun-sensor-atlas/0", "Authorization": f"Bearer {TOKEN}"}
        assert client.post("/api/records", json={}).status_code == 401
        unnamed = {"Authorization": named["Authorization"]}
        assert client.post("/api/records", json={}, headers=unnamed).status_code == 403
        assert client.get("/api/unknown", headers=named).status_code == 405
        made = client.post(
            "/api/records", json={"metadata": {}, "files": {"enabled": True}}, headers=named
        ).json()["id"]
        at = f"/api/records/{made}/draft"
        put = {**named, "Content-Type": "application/octet-stream"}
        assert client.put(f"{at}/files/a/content", content=b"x", headers=put).status_code == 404
        assert client.post(f"{at}/actions/publish", headers=named).status_code == 400
        assert client.post(f"{at}/files", json=[{"key": "a"}], headers=named).status_code == 201
        assert client.post(f"{at}/files/a/commit", headers=named).status_code == 400
        assert client.put(f"{at}/files/a/content", content=b"x", headers=named).status_code == 415
