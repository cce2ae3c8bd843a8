"""Draw sentences as readers meet them: `python -m tools.draw_sentences 50 --seed 1`.

From pages as they are served, docs, help of commands and the HTTP API's descriptions; each with the
place it is of. Every place of a kind is as likely as another, and so is each of its sentences.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

import httpx

from api.server.app import create_app
from tools.prose.texts import Block, documents, help_texts, html, openapi, sentences

#: Kinds of text, and their shares in a draw.
SHARES = {"pages": 0.5, "docs": 0.3, "help": 0.1, "openapi": 0.1}
#: Words of the shortest sentence that is drawn; a name or a label is none.
SHORTEST = 5
PAGES = (
    *("/", "/?task=Accuracy", "/?task=Cost&max_error_deg=0.1", "/studies", "/claims"),
    *(
        "/datasets",
        "/leaderboard",
        "/algorithms",
        "/figures",
        "/compare",
        "/calibrate",
        "/glossary",
    ),
    *("/search?q=albedo", "/bibliography", "/figures/cross-analysis", "/figures/error"),
)
#: Lists of which some members' pages are drawn from.
LISTS = {"/studies": "key", "/datasets": "name", "/claims": "id", "/algorithms": "name"}
MEMBERS = 6


def _get(address: str) -> httpx.Response:
    """Ask the service, without a server."""

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(_service())
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            return await client.get(address, follow_redirects=True)

    return asyncio.run(ask())


@cache
def _service() -> Any:
    return create_app()


def pages(chance: random.Random) -> Iterator[Block]:
    """Give the blocks of served pages: the fixed ones, and some of each list."""
    places = list(PAGES)
    for path, key in LISTS.items():
        rows = _get(f"/v1{path}?limit=500").json()["items"]
        places += [f"{path}/{row[key]}" for row in chance.sample(rows, MEMBERS)]
    for place in places:
        answer = _get(place)
        if answer.is_success and "text/html" in answer.headers["content-type"]:
            yield from html(place, answer.text)


def draw(number: int, seed: int) -> list[tuple[str, str]]:
    """Return so many sentences, each with its place."""
    chance = random.Random(seed)
    kinds = {
        "pages": list(pages(chance)),
        "docs": list(documents()),
        "help": list(help_texts()),
        "openapi": list(openapi()),
    }
    drawn: list[tuple[str, str]] = []
    for kind, share in SHARES.items():
        places: dict[str, set[str]] = {}
        for block in kinds[kind]:
            said = {one for one in sentences(block.text) if _is_sentence(one)}
            places.setdefault(block.where, set()).update(said)
        ways = sorted(place for place, said in places.items() if said)
        wanted = round(number * share)
        found: dict[str, str] = {}
        while len(found) < wanted:
            place = chance.choice(ways)
            found.setdefault(chance.choice(sorted(places[place])), place)
        drawn += [(place, sentence) for sentence, place in found.items()]
    return drawn


def _is_sentence(text: str) -> bool:
    """Return whether a text is a sentence, and not a name, a label or a cell of numbers."""
    return len(text.split()) >= SHORTEST and text.endswith((".", "?", "!"))


def main() -> int:
    """Print the drawn sentences, one a line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("number", type=int, help="how many sentences")
    parser.add_argument("--seed", type=int, default=0, help="of the draw")
    options = parser.parse_args()
    for number, (place, sentence) in enumerate(draw(options.number, options.seed), start=1):
        sys.stdout.write(f"{number:3} {place}: {sentence}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
