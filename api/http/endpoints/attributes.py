"""Filters by the attributes of studies, shared by several endpoints."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from api.http.knowledge import Knowledge
from api.http.parameters import Arguments, Parameter
from api.http.values import Choice
from registry.studies import Study
from registry.taxonomy import ATTRIBUTES


def values_of(knowledge: Knowledge, attribute: str) -> Callable[[], Sequence[str]]:
    """Return what gives the valid values of `attribute`."""
    return lambda: knowledge.taxonomy.values(attribute)


def attribute_filters(knowledge: Knowledge) -> list[Parameter]:
    """Return one repeatable parameter an attribute."""
    return [
        Parameter(
            attribute,
            Choice(values_of(knowledge, attribute)),
            f"Only studies with one of these values of {attribute} (a parent such as ECM covers "
            "its kinds). Different attributes must all match."
            if attribute == "model"
            else f"Only studies with one of these values of {attribute}. "
            "Different attributes must all match.",
            repeatable=True,
        )
        for attribute in ATTRIBUTES
    ]


def wanted_values(arguments: Arguments) -> dict[str, tuple[str, ...]]:
    """Return the attribute filters that are given."""
    return {attribute: arguments[attribute] for attribute in ATTRIBUTES if arguments[attribute]}


def has_values(knowledge: Knowledge, study: Study, wanted: dict[str, tuple[str, ...]]) -> bool:
    """Say whether a study has, of every attribute, one of the wanted values or of their kinds."""
    kinds = knowledge.taxonomy.kinds
    return all(
        not set(study.of(attribute)).isdisjoint(
            kind for value in values for kind in kinds(attribute, value)
        )
        for attribute, values in wanted.items()
    )
