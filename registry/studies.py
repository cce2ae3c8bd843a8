"""The studies of the survey, every value with its provenance.

`facts()` reads the survey once; everything in `registry` that needs studies takes a `Facts`, so
that other tables can be handed in.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from types import MappingProxyType, SimpleNamespace

from registry.fidelity.particulars import (
    Advice,
    CompensatedModel,
    MethodVariant,
    PurposeRule,
    RunFact,
    conditions,
    hardware_facts,
    purpose_rule,
)
from registry.taxonomy import (
    NUMERIC_ATTRIBUTES,
    Taxonomy,
    TaxonomyEntry,
    unknown_name,
)
from survey_data import facts_manifest
from survey_data.editions import (
    BY_STUDY,
    CHOICES,
    EXTENSION,
    EXTENSION_TABLES,
    SURVEY,
    Choice,
)
from survey_data.json_data import JsonData
from survey_data.reported import (
    KIND_OF,
    Quantity,
    ReportedAccuracy,
    reported_accuracies,
)
from survey_data.sources import source_named
from survey_data.texts import load_texts

METHODS = ("model", "extractor")
"""Attributes whose values a study proposes, or only compares against."""


@dataclass(frozen=True)
class AttributeValue:
    """A value of one of a study's attributes, and where it comes from."""

    value: str
    basis: str  # of survey_data/bases.csv, such as survey-table, abstract, inferred
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
class NameInStudy:
    """What a study itself calls one of its values.

    ``is_nearest`` says that the taxonomy has no such value and that the one given is only the
    nearest to it: what runs that value is not the study's own.
    """

    name: str
    is_nearest: bool


@dataclass(frozen=True)
class Verification(JsonData):
    """Who confirmed what of a study, on which day, and where that can be seen."""

    name: str
    date: str
    confirms: str
    source: str


@dataclass(frozen=True)
class Study:
    """One study of the survey's mapping, or one after it (`edition`).

    ``values`` holds the stated values only; an attribute whose cell is empty is absent from it
    and stands in ``unknown`` with the note beside the empty cell. ``roles`` are those of
    (attribute, value), where one is known; ``combinations`` says which detector goes with which
    mask where not every one goes with every other. ``names`` are what a study outside the survey
    calls its values of (attribute, value); ``verifications`` who confirmed what is said here.
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
    combinations: tuple[tuple[str, str], ...] = ()
    edition: str = SURVEY
    names: Mapping[tuple[str, str], NameInStudy] = field(default_factory=dict, hash=False)
    verifications: tuple[Verification, ...] = ()
    type: str = "unknown"  # journal, conference, preprint, thesis, ...

    def role(self, attribute: str, value: str) -> str:
        """Return `proposed`, `compared` or `unknown`, of a model or an extractor of the study."""
        known = self.roles.get((attribute, value))
        return "unknown" if known is None else known.role

    def has_value(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values that the study uses itself, without those it only compares."""
        return tuple(v for v in self.of(attribute) if self.role(attribute, v) != "compared")

    def has_nearest(self, attribute: str, value: str) -> bool:
        """Say whether a value is only the nearest in the taxonomy to what the study has."""
        name = self.names.get((attribute, value))
        return name is not None and name.is_nearest

    @cached_property
    def architectures(self) -> tuple[tuple[str, str], ...]:
        """Detector and mask of each sensor that the study can have had; empty if one is unknown."""
        every = itertools.product(self.of("detector"), self.of("mask"))
        return self.combinations or tuple(every)

    def has_sensor(self, values: Mapping[str, str | None]) -> bool:
        """Say whether a sensor of the study can have these values of detector and mask."""
        pair = (values.get("detector"), values.get("mask"))
        return not self.combinations or None in pair or pair in self.combinations

    def of(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values of an attribute, without repetition; empty if unknown."""
        return self._stated_values.get(attribute, ())

    @cached_property
    def _stated_values(self) -> Mapping[str, tuple[str, ...]]:
        return {a: tuple(dict.fromkeys(v.value for v in cells)) for a, cells in self.values.items()}

    def number(self, attribute: str) -> float | None:
        """Return a stated number of `NUMERIC_ATTRIBUTES` (the best of several); None if none."""
        if attribute not in NUMERIC_ATTRIBUTES:
            raise unknown_name("attribute", attribute, NUMERIC_ATTRIBUTES)
        numbers = [float(text) for text in self.of(attribute)]
        if not numbers:
            return None
        return max(numbers) if attribute == "fov_deg" else min(numbers)

    def report(self, quantity: Quantity) -> ReportedAccuracy | None:
        """Return the accuracy or precision that the study reports, with its kind; None if none."""
        attribute = f"{quantity}_deg"
        number = self.number(attribute)
        if number is None:
            return None
        return reported_accuracies(quantity, number, next(iter(self.of(KIND_OF[attribute])), None))

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
            "edition": self.edition,
            "verified": [each.to_dict() for each in self.verifications],
            "values": {attribute: list(self.of(attribute)) for attribute in self.values},
        }

    def to_dict(self) -> dict[str, object]:
        """Return the summary and every cell with its provenance, empty cells included."""
        stated = [(a, cell) for a, cells in self.values.items() for cell in cells]
        empty = [(a, AttributeValue("", "unknown", "", note)) for a, note in self.unknown.items()]
        cells = [
            {
                "attribute": attribute,
                "value": cell.value,
                "basis": cell.basis,
                "source": cell.source,
                "source_name": source_named(cell.source).name,
                "note": cell.note,
                "role": self._role_of_method(attribute, cell.value),
                **self._name(attribute, cell.value),
            }
            for attribute, cell in (*stated, *empty)
        ]
        return {**self.summary(), "note": self.note, "attributes": cells}

    def _role_of_method(self, attribute: str, value: str) -> str:
        return self.role(attribute, value) if value and attribute in METHODS else ""

    def _name(self, attribute: str, value: str) -> dict[str, object]:
        """Return what the study calls a value, and whether the taxonomy has only the nearest."""
        found = self.names.get((attribute, value))
        return {
            "name_in_study": "" if found is None else found.name,
            "nearest": found is not None and found.is_nearest,
        }


@dataclass(frozen=True)
class Default:
    """What stands in an empty cell of a study that meets every condition, and why.

    ``conditions`` are (attribute, value) that the study must have. ``kind`` is implied where the
    value follows from the survey's definition of a method that the study uses, chosen where others
    would fit as well.
    """

    id: str
    attribute: str
    conditions: tuple[tuple[str, str], ...]
    value: str
    section: str
    rule: str
    kind: str = "implied"


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
    compensated_models: tuple[CompensatedModel, ...] = ()
    variants: tuple[MethodVariant, ...] = ()
    run_facts: Mapping[str, tuple[RunFact, ...]] = field(default_factory=dict)
    """Study -> what its run is judged by beyond its values."""

    def calibration(self, study: str) -> str:
        """Say how a study comes by the constants of its model; empty where that is not known."""
        return next((f.value for f in self.run_facts.get(study, ()) if f.fact == "calibration"), "")

    def variant(self, study: str, model: str) -> MethodVariant | None:
        """Return what is said of how a study carries out one of its models."""
        return next((v for v in self.variants if (v.study, v.model) == (study, model)), None)

    def within(self, study: str, compensation: str) -> tuple[str, ...]:
        """Return the models of a study that carry out one of its compensations themselves."""
        return self._compensate(study, compensation, "within")

    def behind(self, study: str, compensation: str) -> tuple[str, ...]:
        """Return the models that one of a study's compensations corrects the features of."""
        return self._compensate(study, compensation, "ahead")

    def _compensate(self, study: str, compensation: str, relation: str) -> tuple[str, ...]:
        at = (study, compensation, relation)
        rows = (c for c in self.compensated_models if (c.study, c.compensation, c.relation) == at)
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
    *("purposes", "compensated_models", "method_variants", "run_facts", "hardware"),
    *EXTENSION_TABLES,
)


def facts(edition: Choice = "survey") -> Facts:
    """Return an edition's studies and the taxonomy, read once.

    The edition ``all`` has the survey's studies, and then those after it.

    Raises
    ------
    SurveyDataError
        The tables are not as commands wrote them, or cannot be read; names file, row and column.
    """
    if edition not in CHOICES:
        raise unknown_name("edition", edition, CHOICES)
    return _facts(edition)


@lru_cache(maxsize=len(CHOICES))
def _facts(edition: Choice) -> Facts:
    facts_manifest.require_unchanged()
    tables = load_texts(_TABLES)
    if edition == "all":
        for table in BY_STUDY:
            later = getattr(tables, f"extension_{table}")
            if table == "studies":
                later = [{**row, "edition": EXTENSION} for row in later]
            setattr(tables, table, [*getattr(tables, table), *later])
    return facts_from(tables)


def study_from(rows: Mapping[str, Sequence[Mapping[str, str]]]) -> Study:
    """Return a study the survey does not map that is in no table yet.

    `rows` are by table of the extension, without its prefix; one of ``studies``.
    """
    tables = load_texts(_TABLES)
    for table in BY_STUDY:
        setattr(tables, table, list(rows.get(table, ())))
    tables.studies = [{**row, "edition": EXTENSION} for row in tables.studies]
    tables.extension_names, tables.verifications = list(rows.get("names", ())), []
    (found,) = facts_from(tables).studies.values()
    return found


def studies() -> Mapping[str, Study]:
    """Every study of the survey by key, in the table's order."""
    return facts().studies


def study(key: str) -> Study:
    """One study of the survey; InvalidValueError naming the nearest key if there is none."""
    return facts().study(key)


def facts_from(tables: SimpleNamespace) -> Facts:
    """Facts from valid tables with the survey's columns, as `load_texts` gives them."""
    rings = {("model", row["model"]): row["calibration"] for row in tables.model_families}
    taxonomy = Taxonomy(
        TaxonomyEntry(
            attribute=row["attribute"],
            value=row["value"],
            name=row["name"],
            category=row["category"],
            section=row["survey_section"],
            calibration=rings.get((row["attribute"], row["value"]), ""),
        )
        for row in tables.taxonomy
    )
    stated: dict[str, dict[str, list[AttributeValue]]] = {}
    unknown: dict[str, dict[str, str]] = {}
    for row in tables.attributes:
        key, attribute, value = row["study"], row["attribute"], row["value"]
        if value == "":
            unknown.setdefault(key, {})[attribute] = row["note"]
            continue
        cell = AttributeValue(value, row["basis"], row["source"], row["note"])
        stated.setdefault(key, {}).setdefault(attribute, []).append(cell)
    roles: dict[str, dict[tuple[str, str], MethodRole]] = {}
    for row in tables.roles:
        role = MethodRole(row["role"], row["basis"], row["source"], row["note"])
        roles.setdefault(row["study"], {})[row["attribute"], row["value"]] = role
    combined: dict[str, tuple[tuple[str, str], ...]] = {}
    for row in tables.architectures:
        pair = (row["detector"], row["mask"])
        combined[row["study"]] = (*combined.get(row["study"], ()), pair)
    names, verified = _names(tables), _verify(tables)
    found: dict[str, Study] = {}
    for row in tables.studies:
        key = row["key"]
        found[key] = Study(
            **{**row, "year": int(row["year"]) if row["year"] else None},
            values=MappingProxyType(
                {attribute: tuple(cells) for attribute, cells in stated.pop(key, {}).items()}
            ),
            unknown=MappingProxyType(unknown.pop(key, {})),
            roles=MappingProxyType(roles.get(key, {})),
            combinations=combined.get(key, ()),
            names=MappingProxyType(names.get(key, {})),
            verifications=tuple(verified.get(key, ())),
        )
    return Facts(
        MappingProxyType(found),
        taxonomy,
        tuple(map(_default, tables.defaults)),
        tuple(map(_advice, tables.advice)),
        _properties(tables, taxonomy),
        tuple(map(purpose_rule, tables.purposes)),
        tuple(CompensatedModel(**row) for row in tables.compensated_models),
        tuple(MethodVariant(**row) for row in tables.method_variants),
        _run_facts(tables),
    )


def _run_facts(tables: SimpleNamespace) -> Mapping[str, tuple[RunFact, ...]]:
    """Return what runs are judged by, by study: its own rows, then what hardware says of it."""
    found: dict[str, tuple[RunFact, ...]] = {}
    rows = (RunFact(**row) for row in tables.run_facts)
    built = (f for row in tables.hardware for f in hardware_facts(row))
    for one in (*rows, *built):
        found[one.study] = (*found.get(one.study, ()), one)
    return MappingProxyType(found)


def _names(tables: SimpleNamespace) -> dict[str, dict[tuple[str, str], NameInStudy]]:
    """Return what studies call their values, by study."""
    found: dict[str, dict[tuple[str, str], NameInStudy]] = {}
    for row in tables.extension_names:
        name = NameInStudy(row["name"], row["nearest"].casefold() == "true")
        found.setdefault(row["study"], {})[row["attribute"], row["value"]] = name
    return found


def _verify(tables: SimpleNamespace) -> dict[str, list[Verification]]:
    """Return the confirmations by study."""
    found: dict[str, list[Verification]] = {}
    for row in tables.verifications:
        one = Verification(row["name"], row["date"], row["confirms"], row["source"])
        found.setdefault(row["study"], []).append(one)
    return found


def _properties(tables: SimpleNamespace, taxonomy: Taxonomy) -> Mapping[str, Mapping[str, int]]:
    """Return the marks by property; of several methods under one value the best counts."""
    values = {value: value for value in taxonomy.values("extractor")}
    for row in tables.aliases:
        if row["attribute"] == "extractor":
            values[row["alias"]] = row["value"]
    found: dict[str, dict[str, int]] = {}
    for row in tables.feature_assessment:
        marks = found.setdefault(row["property"], {})
        value = values[row["extractor"]]
        marks[value] = max(int(row["score"]), marks.get(value, 0))
    return MappingProxyType({name: MappingProxyType(marks) for name, marks in found.items()})


def _advice(row: Mapping[str, str]) -> Advice:
    named = ("id", "requirement", "value", "detector", "mask", "model_category", "extractor")
    return Advice(*(row[name] for name in (*named, "survey_section", "note")))


def _default(row: Mapping[str, str]) -> Default:
    return Default(
        *(row["id"], row["attribute"], conditions(row["given"]), row["value"]),
        *(row["survey_section"], row["rule"], row["kind"]),
    )
