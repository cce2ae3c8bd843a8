"""URLs of pages and of their JSON and CSV versions."""

from __future__ import annotations

from collections.abc import Mapping
from urllib.parse import quote, urlencode

NAVIGATION: Mapping[str, tuple[tuple[str, str], ...]] = {
    "Answer": (
        ("/", "Answer"),
        ("/compare", "Compare"),
        ("/detectors", "Detectors"),
        ("/masks", "Masks"),
    ),
    "Evidence": (
        ("/studies", "Studies"),
        ("/claims", "Claims"),
        ("/directions", "Directions"),
        ("/figures", "Figures"),
        ("/algorithms", "Algorithms"),
        ("/bibliography", "Bibliography"),
    ),
    "Measurements": (
        ("/leaderboard", "Leaderboard"),
        ("/datasets", "Data sets"),
        ("/experiments", "Experiments"),
        ("/figures/gap", "Gap"),
        ("/figures/trade-off", "Trade-off"),
        ("/figures/robustness", "Robustness"),
    ),
    "Calibrate": (("/calibrate", "Calibrate"),),
    "Guide": (("/guide", "Guide"), ("/glossary", "Glossary"), ("/docs", "API reference")),
}
"""Sections in the order of the masthead, each with its pages; its link leads to the first."""
PAGES = tuple(page for pages in NAVIGATION.values() for page in pages)
KINDS = {"detector": "/detectors", "mask": "/masks"}
"""Attributes whose values have a page of their own."""


def place_of(path: str) -> tuple[str, str]:
    """Return the section of `NAVIGATION` that a path belongs to, and its page; "" for none."""
    above = [
        (at, section)
        for section, pages in NAVIGATION.items()
        for at, _ in pages
        if path == at or path.startswith(f"{at}/")
    ]
    at, section = max(above, key=lambda found: len(found[0]), default=("", ""))
    return section, at


def study_page(key: str) -> str:
    """Return the address of a study."""
    return f"/studies/{quote(key, safe='')}"


def cited_study(key: str, form: str) -> str:
    """Return the address of the reference to a study; `form` is bibtex, ris or csl."""
    return f"/v1/studies/{quote(key, safe='')}?format={form}"


def cited_studies(asked: Mapping[str, object], form: str) -> str:
    """Return the address of the references to the studies that filters select."""
    chosen = {name: value for name, value in asked.items() if value not in (None, [], "")}
    return "/v1/studies?" + urlencode({**chosen, "limit": 500, "format": form}, doseq=True)


def algorithm_page(name: str) -> str:
    """Return the address of an implementation."""
    return f"/algorithms/{quote(name, safe='')}"


def dataset_page(name: str, **asked: str) -> str:
    """Return the address of a data set."""
    return _ask(f"/datasets/{quote(name, safe='')}", asked)


def calibrate_page(model: str) -> str:
    """Return the form that calibrates a file by a model."""
    return _ask("/calibrate", {"model": model})


def claim_page(identifier: str) -> str:
    """Return the address of a claim."""
    return f"/claims/{quote(identifier, safe='')}"


def architecture_page(detector: str, mask: str) -> str:
    """Return the address of a detector behind a mask."""
    return f"/architectures/{quote(detector, safe='')}/{quote(mask, safe='')}"


def value_page(attribute: str, value: str) -> str:
    """Return the page of a value of an attribute, or the list of studies with it."""
    if attribute in KINDS:
        return f"{KINDS[attribute]}/{quote(value, safe='')}"
    if attribute in {"model", "extractor"}:
        return f"/algorithms#{anchor(attribute, value)}"
    return _ask("/studies", {attribute: value})


def anchor(attribute: str, value: str) -> str:
    """Return an id of an element for a value: letters, digits and hyphens."""
    kept = "".join(c if c.isalnum() else "-" for c in value)
    return f"{attribute}-{kept}".lower()


def twin(path: str, query: str, suffix: str) -> str:
    """Return the address of a page's twin; that of "/" is called answer."""
    place = "/answer" if path == "/" else quote(path, safe="/+:,@")
    return place + suffix + (f"?{query}" if query else "")


def for_spreadsheets(path: str, query: str) -> str:
    """Return the address of a page's CSV that a spreadsheet can open."""
    return twin(path, "&".join(filter(None, (query, "safe=true"))), ".csv")


def _ask(path: str, asked: dict[str, str]) -> str:
    return f"{path}?{urlencode(asked)}" if asked else path


GIVEN = (
    *(study_page, cited_study, cited_studies),
    *(algorithm_page, dataset_page, calibrate_page, claim_page, architecture_page, value_page),
    *(anchor, twin, for_spreadsheets),
)
"""What templates are given."""
