"""What can be found: studies, algorithms, data sets, claims, attributes, words with a meaning."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol
from urllib.parse import quote

import survey_data
from api.glossary import glossary
from api.service.index.index import Entry
from registry.taxonomy import NO_IMPLEMENTATION_STATED
from survey_data import labels

if TYPE_CHECKING:
    from api.service.measurements import Measurements
    from registry.catalogue import Catalogue
    from registry.studies import Facts
    from registry.taxonomy import Taxonomy
    from survey_data.editions import Choice

KINDS = ("study", "algorithm", "dataset", "claim", "attribute", "word")
"""In the order that breaks ties."""


class EntrySources(Protocol):
    """What entries are made from: `api.service.knowledge.Knowledge`, which imports this module."""

    @property
    def facts(self) -> Facts:
        """Studies and taxonomy."""

    def of(self, edition: Choice) -> EntrySources:
        """Return the same with the studies of an edition."""

    @property
    def taxonomy(self) -> Taxonomy:
        """The vocabulary."""

    @property
    def catalogue(self) -> Catalogue:
        """The implementations."""

    @property
    def measurements(self) -> Measurements:
        """What is measured."""


def entries(known: EntrySources) -> tuple[Entry, ...]:
    """Return all entries of the search, by kind, in the order of their lists."""
    found = (_studies, _algorithms, _datasets, _claims, _attributes, _words)
    return tuple(entry for of_kind in found for entry in of_kind(known))


def _studies(known: EntrySources) -> Iterator[Entry]:
    for study in known.of("all").facts.studies.values():
        values = [
            _name_of(value, known.taxonomy.name(attribute, value))
            for attribute in known.taxonomy.attributes
            for value in study.of(attribute)
        ]
        yield Entry(
            kind="study",
            id=study.key,
            title=study.title or study.key,
            words=f"{study.authors}, {study.year or 'year unknown'}. {study.venue}",
            text="; ".join(dict.fromkeys(values)),
            address=f"/v1/studies/{quote(study.key, safe='')}",
        )


def _algorithms(known: EntrySources) -> Iterator[Entry]:
    for one in known.catalogue.implementations():
        attribute = "extractor" if one.role == "extractor" else "model"
        values = {entry.value: entry.name for entry in known.taxonomy.entries(attribute)}
        yield Entry(
            kind="algorithm",
            id=one.name,
            title=f"{one.title} ({one.name})",
            words=f"{one.taxonomy} {values.get(one.taxonomy, '')} {one.category or ''} "
            f"{' '.join(one.labels)} {' '.join(map(labels.name, one.labels))}",
            text=f"{one.summary} {'; '.join(one.studies)}".strip(),
        )


def _datasets(known: EntrySources) -> Iterator[Entry]:
    for card in known.measurements.cards:
        detector, mask = str(card["detector"]), str(card["mask"])
        name = known.taxonomy.name
        yield Entry(
            kind="dataset",
            id=card["name"],
            title=f"{name('detector', detector)}, {name('mask', mask)}",
            words=f"{detector} {mask} {card['observation']} {' '.join(card['conditions'])}",
            text=str(card["description"]),
            address=f"/v1/datasets/{quote(card['name'], safe='')}",
        )


def _claims(known: EntrySources) -> Iterator[Entry]:
    for entry in known.measurements.claims.values():
        said = entry.claim
        yield Entry(
            kind="claim",
            id=said.id,
            title=said.statement,
            words=f"{said.section} {said.study} {entry.verdict or 'not measured'}",
            text=f"{said.how_to_test}. {said.measured_on}",
            address=f"/v1/claims/{quote(said.id, safe='')}",
        )


def _attributes(_known: EntrySources) -> Iterator[Entry]:
    table = survey_data.load().attribute_definitions
    columns = (table[name] for name in ("attribute", "name", "synonyms", "description"))
    for attribute, name, synonyms, description in zip(*columns, strict=True):
        yield Entry("attribute", attribute, name, synonyms, description, "/v1/taxonomy")


def _words(known: EntrySources) -> Iterator[Entry]:
    meanings = {(one.kind, one.term): one.meaning for one in glossary()}
    for attribute in known.taxonomy.attributes:
        for entry in known.taxonomy.entries(attribute):
            yield Entry(
                kind="word",
                id=f"{attribute}: {entry.value}",
                title=entry.name,
                words=f"{entry.category} {entry.section}",
                text=meanings.get((attribute, entry.value), entry.category or ""),
                address="/v1/taxonomy",
            )
    for term in glossary():
        if term.kind == "term":
            yield Entry(kind="word", id=term.term, title=term.name, text=term.meaning)


def _name_of(value: str, name: str) -> str:
    return name if value in {name, NO_IMPLEMENTATION_STATED} else f"{name} ({value})"
