"""Signposting: typed links by which a machine finds its way about a page (FAIR profile).

A landing page leads to its content (`item`), metadata (`describedby`), licence, authors and type;
these lead back (`collection`, `describes`). All links of a landing page together are its link set
(RFC 9264). See https://signposting.org/FAIR/.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from api.metadata.citation import persistent
from api.metadata.croissant import CONFORMS_TO
from api.metadata.identity import LD_JSON, LICENCES, LINKSET, SCHEMA, Identity

HTML = "text/html"
#: References to a study, as the service gives them.
FORMS: Mapping[str, str] = {
    "bibtex": "application/x-bibtex",
    "ris": "application/x-research-info-systems",
    "csl": "application/vnd.citationstyles.csl+json",
}


@dataclass(frozen=True)
class Link:
    """A typed link.

    Attributes
    ----------
    relation : type of the link, such as ``item``
    target : address, or a path on this service
    media_type, profile : of what is there; None where it is no document
    """

    relation: str
    target: str
    media_type: str | None = None
    profile: str | None = None

    @property
    def header(self) -> str:
        """One value of a Link header (RFC 8288)."""
        parts = [f"<{self.target}>", f'rel="{self.relation}"']
        parts += [f'type="{self.media_type}"'] if self.media_type else []
        parts += [f'profile="{self.profile}"'] if self.profile else []
        return "; ".join(parts)

    def to_dict(self, base: str) -> dict[str, str]:
        """Return the link as a link set has it, its address made whole."""
        return {
            "href": _whole(base, self.target),
            **({"type": self.media_type} if self.media_type else {}),
            **({"profile": self.profile} if self.profile else {}),
        }


@dataclass(frozen=True)
class LandingPage:
    """A page and what belongs to it.

    Attributes
    ----------
    kind : class of schema.org that the page is about, such as ``Dataset``
    licence : "MIT" or "CC-BY-4.0"; None where parts differ
    identifier : persistent address to cite it by; None where there is none
    authors : addresses of people
    items : links to its content
    metadata : links to what describes it
    linkset : path of the link set; None where it has none
    """

    path: str
    kind: str
    licence: str | None = None
    identifier: str | None = None
    authors: Sequence[str] = ()
    items: Sequence[Link] = ()
    metadata: Sequence[Link] = ()
    linkset: str | None = None

    def links(self) -> list[Link]:
        """Return the links of the page."""
        return [
            Link("type", f"{SCHEMA}AboutPage"),
            Link("type", f"{SCHEMA}{self.kind}"),
            *self._terms(),
            *self.items,
            *self.metadata,
            *self._set(),
        ]

    def links_of_content(self) -> list[Link]:
        """Return the links of each of its items."""
        return [Link("collection", self.path, HTML), *self._terms(), *self._set()]

    def links_of_metadata(self) -> list[Link]:
        """Return the links of what describes it."""
        return [Link("describes", self.path, HTML), *self._set()]

    def link_set(self, base: str) -> dict[str, Any]:
        """Return all links of page, content and metadata (RFC 9264, JSON).

        Parameters
        ----------
        base : address of the service, ending in a slash
        """
        anchors = [
            (self.path, self.links()),
            *((item.target, self.links_of_content()) for item in self.items),
            *((about.target, self.links_of_metadata()) for about in self.metadata),
        ]
        return {"linkset": [_context(_whole(base, at), links, base) for at, links in anchors]}

    def _terms(self) -> Iterator[Link]:
        if self.identifier:
            yield Link("cite-as", self.identifier)
        if self.licence:
            yield Link("license", LICENCES[self.licence])
        yield from (Link("author", author) for author in self.authors)

    def _set(self) -> list[Link]:
        return [Link("linkset", self.linkset, LINKSET)] if self.linkset else []


def headers(links: Sequence[Link]) -> tuple[str, ...]:
    """Return the values of a Link header."""
    return tuple(link.header for link in links)


def landing_of_dataset(name: str, who: Identity, *, sampled: bool) -> LandingPage:
    """Return the page of a data set.

    Parameters
    ----------
    name : of the data set
    who : made it
    sampled : whether its errors are published sample by sample
    """
    part = quote(name, safe="")
    at = f"/v1/datasets/{part}"
    parquet = "application/vnd.apache.parquet"
    kinds = ("errors", "directions") if sampled else ()
    return LandingPage(
        f"/datasets/{part}",
        "Dataset",
        "MIT",
        persistent(who.citation),
        authors_of(who),
        (
            *(Link("item", f"{at}/{kind}.parquet", parquet) for kind in kinds),
            Link("item", f"{at}?format=csv", "text/csv"),
        ),
        (
            Link("describedby", f"{at}/croissant.json", LD_JSON, CONFORMS_TO),
            Link("describedby", f"/datasets/{part}.json", "application/json"),
        ),
        f"{at}/linkset.json",
    )


def landing_of_record(who: Identity) -> LandingPage:
    """Return the page of the leaderboard."""
    at = "/v1/leaderboard"
    return LandingPage(
        "/leaderboard",
        "Dataset",
        "MIT",
        persistent(who.citation),
        authors_of(who),
        (Link("item", f"{at}?format=csv&whole=true", "text/csv"),),
        (
            Link("describedby", f"{at}/croissant.json", LD_JSON, CONFORMS_TO),
            Link("describedby", "/leaderboard.json", "application/json"),
        ),
        f"{at}/linkset.json",
    )


def landing_of_study(key: str, doi: str | None) -> LandingPage:
    """Return the page of a study; `doi` is its own."""
    part = quote(key, safe="")
    return LandingPage(
        f"/studies/{part}",
        "ScholarlyArticle",
        "CC-BY-4.0",
        f"https://doi.org/{quote(doi)}" if doi else None,
        metadata=(
            Link("describedby", f"/studies/{part}.json", "application/json"),
            *(
                Link("describedby", f"/v1/studies/{part}?format={form}", media_type)
                for form, media_type in FORMS.items()
            ),
        ),
    )


def landing_of_algorithm(name: str, who: Identity) -> LandingPage:
    """Return the page of an implementation."""
    part = quote(name, safe="")
    return LandingPage(
        f"/algorithms/{part}",
        "SoftwareSourceCode",
        "MIT",
        persistent(who.citation),
        authors_of(who),
        metadata=(Link("describedby", f"/algorithms/{part}.json", "application/json"),),
    )


def landing_of_atlas(who: Identity) -> LandingPage:
    """Return the home page. Facts and code have licences of their own, so that it names none."""
    return LandingPage(
        "/",
        "DataCatalog",
        None,
        persistent(who.citation),
        authors_of(who),
        metadata=(Link("describedby", "/codemeta.json", LD_JSON),),
    )


def authors_of(who: Identity) -> tuple[str, ...]:
    """Return the addresses of the authors that have one, an ORCID iD."""
    return tuple(f"https://orcid.org/{author.orcid}" for author in who.authors if author.orcid)


def _whole(base: str, target: str) -> str:
    """Return an address; a path stands below the service's, which may have a prefix."""
    return base.rstrip("/") + target if target.startswith("/") else target


def _context(anchor: str, links: Sequence[Link], base: str) -> dict[str, Any]:
    found: dict[str, Any] = {"anchor": anchor}
    for link in links:
        found.setdefault(link.relation, []).append(link.to_dict(base))
    return found
