"""The studies of the survey, every value with its provenance.

`facts()` reads the survey once; everything in `registry` that needs studies takes a `Facts`, so
that other tables can be handed in.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from types import MappingProxyType

from registry.advice import Advice
from registry.fidelity.particulars import (
    CompensatedModel,
    MethodVariant,
    PurposeRule,
    compensated_model,
    conditions,
    method_variant,
    purpose_rule,
)
from registry.survey_tables import Tables, rows_of
from registry.taxonomy import (
    NUMERIC_ATTRIBUTES,
    InvalidValueError,
    Taxonomy,
    TaxonomyEntry,
    unknown_name,
)
from survey_data import recorded_facts
from survey_data.numerals import decimal
from survey_data.reported import KIND_OF, Quantity, Reported, reported, statistics
from survey_data.sources import source_named
from survey_data.texts import load_texts


class FactsError(ValueError):
    """The survey's tables can be read and do not fit each other; the message says where."""


METHODS = ("model", "extractor")
"""Attributes whose values a study proposes, or only compares against."""


@dataclass(frozen=True)
class AttributeValue:
    """A value of one of a study's attributes, and where it comes from."""

    value: str
    basis: str  # survey-table, survey-text, abstract, title, inferred, recalled
    source: str
    note: str


@dataclass(frozen=True)
class MethodRole:
    """Whether a study proposed a method or only compared another against it, and who says so."""

    role: str  # proposed, compared
    basis: str
    source: str
    note: str


@dataclass(frozen=True)
class Default:
    """What stands in an empty cell of a study that meets every condition, and why.

    ``given`` are (attribute, value) that the study must have. ``kind`` is implied where the value
    follows from the survey's definition of a method that the study uses, chosen where others would
    fit as well.
    """

    id: str
    attribute: str
    given: tuple[tuple[str, str], ...]
    value: str
    section: str
    rule: str
    kind: str = "implied"


@dataclass(frozen=True)
class Study:
    """One study of the survey's mapping.

    ``values`` holds the stated values only; an attribute whose cell is empty is absent from it
    and stands in ``unknown`` with the note beside the empty cell. ``roles`` are those of
    (attribute, value), where one is known; ``combined`` says which detector goes with which mask
    where not every one goes with every other.
    """

    key: str
    title: str
    authors: str
    year: int | None
    venue: str
    doi: str
    url: str
    identity: str  # confirmed, recalled, ambiguous, unknown
    note: str
    values: Mapping[str, tuple[AttributeValue, ...]]
    unknown: Mapping[str, str]
    roles: Mapping[tuple[str, str], MethodRole] = field(default_factory=dict, hash=False)
    combined: tuple[tuple[str, str], ...] = ()
    type: str = "unknown"  # journal, conference, preprint, thesis, ...

    def role(self, attribute: str, value: str) -> str:
        """Return `proposed`, `compared` or `unknown`, of a model or an extractor of the study."""
        known = self.roles.get((attribute, value))
        return "unknown" if known is None else known.role

    def supported(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values that the study stands for: those it only compared are not."""
        return tuple(v for v in self.of(attribute) if self.role(attribute, v) != "compared")

    @cached_property
    def architectures(self) -> tuple[tuple[str, str], ...]:
        """Detector and mask of each sensor that the study can have had; empty if one is unknown."""
        every = itertools.product(self.of("detector"), self.of("mask"))
        return self.combined or tuple(every)

    def has_sensor(self, values: Mapping[str, str | None]) -> bool:
        """Say whether a sensor of the study can have these values of detector and mask."""
        pair = (values.get("detector"), values.get("mask"))
        return not self.combined or None in pair or pair in self.combined

    def of(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values of an attribute, without repetition; empty if unknown."""
        return self._stated.get(attribute, ())

    @cached_property
    def _stated(self) -> Mapping[str, tuple[str, ...]]:
        return {a: tuple(dict.fromkeys(v.value for v in cells)) for a, cells in self.values.items()}

    def number(self, attribute: str) -> float | None:
        """Return a stated number of `NUMERIC_ATTRIBUTES` (the best of several); None if none."""
        if attribute not in NUMERIC_ATTRIBUTES:
            raise unknown_name("attribute", attribute, NUMERIC_ATTRIBUTES)
        numbers = [float(text) for text in self.of(attribute)]
        if not numbers:
            return None
        return max(numbers) if attribute == "fov_deg" else min(numbers)

    def reported(self, quantity: Quantity) -> Reported | None:
        """Return the accuracy or precision that the study reports, with its kind; None if none."""
        attribute = f"{quantity}_deg"
        number = self.number(attribute)
        if number is None:
            return None
        return reported(quantity, number, next(iter(self.of(KIND_OF[attribute])), None))

    def summary(self) -> dict[str, object]:
        """Identity and values, as in a list of studies."""
        return {
            "key": self.key,
            "title": self.title,
            "authors": self.authors,
            "year": self.year,
            "venue": self.venue,
            "type": self.type,
            "doi": self.doi,
            "url": self.url,
            "identity": self.identity,
            "values": {attribute: list(self.of(attribute)) for attribute in self.values},
        }

    def to_dict(self) -> dict[str, object]:
        """Return the summary and every cell with its provenance, empty cells included."""
        cells = [
            {
                "attribute": attribute,
                "value": cell.value,
                "basis": cell.basis,
                "source": cell.source,
                "source_name": source_named(cell.source).name,
                "note": cell.note,
                "role": self.role(attribute, cell.value) if attribute in METHODS else "",
            }
            for attribute, cells in self.values.items()
            for cell in cells
        ]
        cells += [
            {
                "attribute": a,
                "value": "",
                "basis": "unknown",
                "source": "",
                "source_name": "",
                "note": note,
                "role": "",
            }
            for a, note in self.unknown.items()
        ]
        return {**self.summary(), "note": self.note, "attributes": cells}


@dataclass(frozen=True, eq=False)
class Facts:
    """The studies and the vocabulary they are described with."""

    studies: Mapping[str, Study]
    taxonomy: Taxonomy
    defaults: tuple[Default, ...] = ()
    advice: tuple[Advice, ...] = ()
    properties: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    """Property of the survey's assessment -> value of an extractor -> its mark, 0 to 2."""
    purposes: tuple[PurposeRule, ...] = ()
    compensated: tuple[CompensatedModel, ...] = ()
    variants: tuple[MethodVariant, ...] = ()

    def variant(self, study: str, model: str) -> MethodVariant | None:
        """Return what is said of how a study carries out one of its models."""
        return next((v for v in self.variants if (v.study, v.model) == (study, model)), None)

    def within(self, study: str, compensation: str) -> tuple[str, ...]:
        """Return the models of a study that carry out one of its compensations themselves."""
        return self._compensated(study, compensation, "within")

    def behind(self, study: str, compensation: str) -> tuple[str, ...]:
        """Return the models that one of a study's compensations corrects the features of."""
        return self._compensated(study, compensation, "ahead")

    def _compensated(self, study: str, compensation: str, relation: str) -> tuple[str, ...]:
        at = (study, compensation, relation)
        rows = (c for c in self.compensated if (c.study, c.compensation, c.relation) == at)
        return tuple(c.model for c in rows)

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """Study keys in order; the position of a study is its bit in a study set."""
        return tuple(self.studies)

    def study(self, key: str) -> Study:
        """One study; InvalidValueError naming the nearest key if there is none."""
        if key not in self.studies:
            raise unknown_name("study", key, self.studies)
        return self.studies[key]


_TABLES = (
    *("studies", "attributes", "taxonomy", "model_families", "roles", "architectures"),
    *("defaults", "advice", "feature_assessment", "aliases"),
    *("purposes", "compensated_models", "method_variants"),
)


@lru_cache(maxsize=1)
def facts() -> Facts:
    """Return the survey's studies and taxonomy, read once.

    Raises
    ------
    SurveyDataError
        The tables are not as commands wrote them, or cannot be read; names file, row and column.
    FactsError
        They contradict each other.
    """
    recorded_facts.require_unchanged()
    tables = load_texts(_TABLES)
    try:
        return facts_from(tables)
    except (LookupError, ValueError) as error:
        raise FactsError(f"the tables contradict each other: {error}") from error


def studies() -> Mapping[str, Study]:
    """Every study of the survey by key, in the table's order."""
    return facts().studies


def study(key: str) -> Study:
    """One study of the survey; InvalidValueError naming the nearest key if there is none."""
    return facts().study(key)


def facts_from(tables: Tables) -> Facts:
    """Facts from tables with the survey's columns.

    Raises InvalidValueError for a value outside the taxonomy and ValueError for attributes of a
    study that is not in the table of studies.
    """
    rings = {("model", row["model"]): row["calibration"] for row in rows_of(tables.model_families)}
    taxonomy = Taxonomy(
        TaxonomyEntry(
            attribute=row["attribute"],
            value=row["value"],
            name=row["name"],
            category=row["category"],
            section=row["survey_section"],
            calibration=rings.get((row["attribute"], row["value"]), ""),
        )
        for row in rows_of(tables.taxonomy)
    )
    stated: dict[str, dict[str, list[AttributeValue]]] = {}
    unknown: dict[str, dict[str, str]] = {}
    for row in rows_of(tables.attributes):
        key, attribute, value = row["study"], row["attribute"], row["value"]
        if value == "":
            unknown.setdefault(key, {})[attribute] = row["note"]
            continue
        if attribute in NUMERIC_ATTRIBUTES:
            _require_number(key, attribute, value)
        elif attribute in KIND_OF.values():
            _require_kind(key, attribute, value)
        else:
            taxonomy.require(attribute, value, parameter=f"{key} {attribute}")
        cell = AttributeValue(value, row["basis"], row["source"], row["note"])
        stated.setdefault(key, {}).setdefault(attribute, []).append(cell)
    roles: dict[str, dict[tuple[str, str], MethodRole]] = {}
    for row in rows_of(tables.roles):
        role = MethodRole(row["role"], row["basis"], row["source"], row["note"])
        roles.setdefault(row["study"], {})[row["attribute"], row["value"]] = role
    combined: dict[str, tuple[tuple[str, str], ...]] = {}
    for row in rows_of(tables.architectures):
        pair = (row["detector"], row["mask"])
        combined[row["study"]] = (*combined.get(row["study"], ()), pair)
    found: dict[str, Study] = {}
    for row in rows_of(tables.studies):
        key = row["key"]
        if key in found:
            raise ValueError(f"study {key!r} stands twice in the table of studies")
        found[key] = Study(
            key=key,
            title=row["title"],
            authors=row["authors"],
            year=int(float(row["year"])) if row["year"] else None,
            venue=row["venue"],
            doi=row["doi"],
            url=row["url"],
            identity=row["identity"],
            note=row["note"],
            values=MappingProxyType(
                {attribute: tuple(cells) for attribute, cells in stated.pop(key, {}).items()}
            ),
            unknown=MappingProxyType(unknown.pop(key, {})),
            roles=MappingProxyType(roles.get(key, {})),
            combined=combined.get(key, ()),
            type=row.get("type", "unknown"),
        )
    strangers = sorted({*stated, *unknown})
    if strangers:
        raise ValueError(
            f"attributes of studies not in the table of studies: {', '.join(strangers)}"
        )
    return Facts(
        MappingProxyType(found),
        taxonomy,
        tuple(map(_default, rows_of(tables.defaults))),
        tuple(map(_advice, rows_of(tables.advice))),
        _properties(tables, taxonomy),
        tuple(map(purpose_rule, rows_of(tables.purposes))),
        tuple(map(compensated_model, rows_of(tables.compensated_models))),
        tuple(map(method_variant, rows_of(tables.method_variants))),
    )


def _require_number(key: str, attribute: str, value: str) -> None:
    """Raise InvalidValueError for a numeric cell that is no finite number, spelt plainly."""
    try:
        decimal(value)
    except ValueError as error:
        raise InvalidValueError(f"{key} {attribute}", value, "a number in degrees") from error


def _require_kind(key: str, attribute: str, value: str) -> None:
    """Raise InvalidValueError for a kind of accuracy or precision that no rule is known for."""
    if value not in statistics():
        expected = f"one of {', '.join(statistics())}"
        raise InvalidValueError(f"{key} {attribute}", value, expected)


def _properties(tables: Tables, taxonomy: Taxonomy) -> Mapping[str, Mapping[str, int]]:
    """Return the marks by property; of several methods under one value the best counts."""
    values = {value: value for value in taxonomy.values("extractor")}
    for row in rows_of(tables.aliases):
        if row["attribute"] == "extractor":
            values[row["alias"]] = row["value"]
    found: dict[str, dict[str, int]] = {}
    for row in rows_of(tables.feature_assessment):
        marks = found.setdefault(row["property"], {})
        value = values[row["extractor"]]
        marks[value] = max(int(float(row["score"])), marks.get(value, 0))
    return MappingProxyType({name: MappingProxyType(marks) for name, marks in found.items()})


def _advice(row: Mapping[str, str]) -> Advice:
    named = ("id", "requirement", "value", "detector", "mask", "model_category", "extractor")
    return Advice(*(row[name] for name in (*named, "survey_section", "note")))


def _default(row: Mapping[str, str]) -> Default:
    return Default(
        *(row["id"], row["attribute"], conditions(row["given"]), row["value"]),
        *(row["survey_section"], row["rule"], row["kind"]),
    )
