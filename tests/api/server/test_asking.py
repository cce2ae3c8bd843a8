"""The start page is asked for as the service begins, so that its first visitor does not wait."""

import asyncio
from html.parser import HTMLParser

from api.web.asking import fetch_answer, visit_start_page


class Pictures(HTMLParser):
    """Where the images of a page lie."""

    def __init__(self, page):
        super().__init__()
        self.found = set()
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        if tag == "img":
            self.found.add(dict(attrs)["src"].partition("#")[0])


def test_the_start_page_and_each_picture_on_it_are_asked_for(atlas):
    asked = {}

    async def noted(scope, receive, send):
        async def answered(message):
            if message["type"] == "http.response.start":
                asked[scope["path"]] = message["status"]
            await send(message)

        await atlas.app(scope, receive, answered)

    asyncio.run(visit_start_page(noted))
    shown = Pictures(atlas.get("/", headers={"accept": "text/html"}).text).found
    assert len(shown) > 2
    assert asked == dict.fromkeys({"/", *shown}, 200)


def test_an_answer_in_this_process_is_that_of_the_service(atlas):
    status, body = asyncio.run(fetch_answer(atlas.app, "/v1/studies", "limit=2", b"text/csv"))
    assert (status, body) == (200, atlas.get("/v1/studies?limit=2&format=csv").content)


def test_a_server_begins_with_that_visit(atlas, monkeypatch):
    visited = []

    async def visit(service):
        visited.append(service)

    monkeypatch.setattr("api.server.app.visit_start_page", visit)

    async def begin():
        async with atlas.app.router.lifespan_context(atlas.app):
            await asyncio.sleep(0)

    asyncio.run(begin())
    assert visited == [atlas.app]
