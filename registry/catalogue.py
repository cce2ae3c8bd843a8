"""The catalogue: every extractor, and every model alone or behind compensations, by discovery.

Nothing is registered by hand. The first call of `catalogue()` imports the implementations, and
with them NumPy; importing this module does not. SciPy and Numba are loaded when they run.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from algorithms.display_names import display_name
from registry import studies as registered
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Taxonomy, unknown_name
from survey_data import labels
from survey_data.json_data import JsonData

if TYPE_CHECKING:
    from algorithms.chain import Chain, Scored
    from algorithms.contract import Extractor

Role = Literal["extractor", "model"]


@dataclass(frozen=True)
class Implementation(JsonData):
    """What the catalogue says of one implementation."""

    name: str
    role: Role
    taxonomy: str
    category: str
    observation: str | None  # extractors: what it reads
    kind: str | None  # extractors: what its features mean
    accepts: tuple[str, ...] | None  # models: the kinds of features it reads
    labels: tuple[str, ...]
    studies: tuple[str, ...]
    origin: str
    version: int
    summary: str

    @property
    def title(self) -> str:
        """Display name."""
        return display_name(self.name)

    def to_dict(self) -> dict[str, Any]:
        """As in the HTTP answer."""
        named = [labels.name(label) for label in self.labels]
        return {**super().to_dict(), "title": self.title, "label_names": named}


class Catalogue:
    """Implementations by name and by taxonomy value.

    One whose taxonomy value is not in `taxonomy`, or whose name is another's, raises ValueError.
    """

    def __init__(
        self,
        extractors: Mapping[str, type[Extractor]],
        models: Mapping[str, Scored],
        taxonomy: Taxonomy,
    ) -> None:
        shared = sorted(extractors.keys() & models.keys())
        if shared:
            raise ValueError(f"both an extractor and a model are named {', '.join(shared)}")
        self.extractors: Mapping[str, type[Extractor]] = MappingProxyType(dict(extractors))
        self.models: Mapping[str, Scored] = MappingProxyType(dict(models))
        self.taxonomy = taxonomy
        self._extractors_for = _by_value("extractor", self.extractors, taxonomy)
        self._models_for = _by_value("model", self.models, taxonomy)

    def extractor(self, name: str) -> type[Extractor]:
        """Return the extractor of this name; InvalidValueError with the nearest name."""
        if name not in self.extractors:
            raise unknown_name("extractor", name, self.extractors)
        return self.extractors[name]

    def model(self, name: str) -> Scored:
        """Return the model of this name; InvalidValueError with the nearest name."""
        if name not in self.models:
            raise unknown_name("model", name, self.models)
        return self.models[name]

    def extractors_for(self, value: str) -> tuple[type[Extractor], ...]:
        """Return the extractors implementing a taxonomy value, by name; empty if none does."""
        self.taxonomy.require("extractor", value)
        return tuple(self.extractors[name] for name in self._extractors_for.get(value, ()))

    def implementations(self, role: Role | None = None) -> tuple[Implementation, ...]:
        """Every implementation, extractors first, each by taxonomy order and name."""
        found = [
            *(self._describe("extractor", c) for c in self.extractors.values()),
            *(self._describe("model", c) for c in self.models.values()),
        ]
        order = {
            r: {v: i for i, v in enumerate(self.taxonomy.values(r))} for r in ("extractor", "model")
        }
        found.sort(key=lambda i: (i.role, order[i.role][i.taxonomy], i.name))
        return tuple(i for i in found if role is None or i.role == role)

    def gaps(self) -> tuple[tuple[str, str], ...]:
        """(attribute, value) of every extractor and model of the taxonomy without implementation.

        "None" needs none; a parent such as ECM is covered by any of its kinds.
        """
        return tuple(
            (attribute, value)
            for attribute, known in (
                ("extractor", self._extractors_for),
                ("model", self._models_for),
            )
            for value in self.taxonomy.values(attribute)
            if value != NO_IMPLEMENTATION_STATED
            and not any(kind in known for kind in self.taxonomy.kinds(attribute, value))
        )

    def _describe(self, role: Role, one: type[Extractor] | Scored) -> Implementation:
        about: Any = one.about
        reads = role == "extractor"
        return Implementation(
            name=about.name,
            role=role,
            taxonomy=about.taxonomy,
            category=self.taxonomy.category(role, about.taxonomy),
            observation=str(about.observation) if reads else None,
            kind=str(about.kind) if reads else None,
            accepts=None if reads else tuple(sorted(str(kind) for kind in about.accepts)),
            labels=tuple(about.labels),
            studies=tuple(about.studies),
            origin=about.origin,
            version=about.version,
            summary=_summary(one),
        )


@lru_cache(maxsize=1)
def catalogue() -> Catalogue:
    """Everything implemented in `algorithms`, against the survey's taxonomy."""
    discovery = importlib.import_module("algorithms.discovery")
    return Catalogue(
        discovery.discover_extractors(),
        discovery.discover_chains(),
        registered.facts().taxonomy,
    )


def _by_value(
    attribute: Role,
    found: Mapping[str, type[Extractor] | Scored],
    taxonomy: Taxonomy,
) -> dict[str, tuple[str, ...]]:
    names: dict[str, list[str]] = {}
    for name, cls in sorted(found.items()):
        taxonomy.require(attribute, cls.about.taxonomy, parameter=f"{attribute} {name}")
        names.setdefault(cls.about.taxonomy, []).append(name)
    return {value: tuple(n) for value, n in names.items()}


def _summary(cls: type | Chain) -> str:
    """Return the first paragraph of the class's own docstring, on one line."""
    from algorithms.chain import Chain  # noqa: PLC0415 - loads NumPy

    if isinstance(cls, Chain):
        stages = " ".join(_summary(stage) for stage in cls.compensations)
        return f"{stages} Then {cls.model.about.name}."
    paragraph, _, _ = inspect.cleandoc(cls.__doc__ or "").partition("\n\n")
    return " ".join(paragraph.split())
