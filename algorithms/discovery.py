"""Every extractor, compensation and model there is, found by walking the modules that hold them.

A class counts when it is public, is written in the module walked (not imported into it), and has
the contract's method. Modules and classes with a leading underscore are skipped, and modules of
compiled loops (``*_kernel``), which load Numba: their users import them at first use.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from types import ModuleType
from typing import cast

import algorithms.compensations
import algorithms.extractors
import algorithms.models
from algorithms.chain import Chain, chains
from algorithms.compensations.combinations import combinations
from algorithms.contract import About, Compensation, Extractor, Model


def discover_extractors() -> dict[str, type[Extractor]]:
    """Extractor classes by their unique name, in alphabetical order.

    Raises
    ------
    TypeError
        If a class extracts but lacks part of the contract, or is not a frozen dataclass.
    ValueError
        If two classes carry the same name.
    """
    found = implementations(algorithms.extractors, Extractor, "extract")
    for name, implementation in found.items():
        # dataclass keeps how it was called here; it has no public name.
        if not implementation.__dataclass_params__.frozen:  # type: ignore[attr-defined]
            raise TypeError(f"extractor {name} must be a frozen dataclass")
    return cast("dict[str, type[Extractor]]", found)


def discover_compensations() -> dict[str, type[Compensation]]:
    """Compensation classes by their unique name, in alphabetical order.

    Raises
    ------
    TypeError
        If a class transforms but lacks part of the contract, or is not a dataclass.
    ValueError
        If two classes carry the same name.
    """
    found = implementations(algorithms.compensations, Compensation, "transform")
    return cast("dict[str, type[Compensation]]", found)


def discover_models() -> dict[str, type[Model]]:
    """Model classes by their unique name, in alphabetical order.

    Raises
    ------
    TypeError
        If a class predicts but lacks part of the contract, or is not a dataclass.
    ValueError
        If two classes carry the same name.
    """
    return cast("dict[str, type[Model]]", implementations(algorithms.models, Model, "predict"))


def discover_chains() -> dict[str, type[Model] | Chain]:
    """Models alone, behind compensations that say they go ahead of them, and as studies combined.

    Raises
    ------
    TypeError
        As `discover_models` and `discover_compensations`.
    ValueError
        As these, where a compensation goes ahead of a model that there is not, and where a
        combination has no such parts or is planned already.
    """
    models, compensations = discover_models(), discover_compensations()
    named = chains(compensations, models)
    used = combinations(compensations, models)
    if twice := sorted(named.keys() & used.keys()):
        raise ValueError(f"planned already by a compensation's ahead_of: {', '.join(twice)}")
    return {**models, **named, **used}


def implementations(package: ModuleType, contract: type, method: str) -> dict[str, type]:
    """Public classes of a package's modules that have `method`, by the name in ``about``.

    Parameters
    ----------
    package : module
        The package walked, its sub-packages included.
    contract : type
        The protocol whose annotations and methods each class must carry.
    method : str
        The method that makes a class an implementation.

    Raises
    ------
    TypeError
        If an implementation lacks part of `contract`, or is not a dataclass.
    ValueError
        If two implementations carry the same name.
    """
    members = _members(contract)
    found: dict[str, type] = {}
    for implementation in _public_classes(package):
        if not callable(getattr(implementation, method, None)):
            continue
        where = f"{implementation.__module__}.{implementation.__qualname__}"
        missing = sorted(
            {member for member in members if not hasattr(implementation, member)}
            | getattr(implementation, "__abstractmethods__", frozenset())
        )
        if missing:
            raise TypeError(f"{where} lacks {', '.join(missing)} of the {contract.__name__}")
        about = vars(implementation).get("about")
        if not isinstance(about, About):
            raise TypeError(f"{where} must say of itself what it is: about must be an About")
        if not dataclasses.is_dataclass(implementation):
            raise TypeError(f"{where} must be a dataclass: its fields are its parameters")
        name = about.name
        if name in found:
            other = found[name]
            raise ValueError(
                f"two implementations are named {name!r}: "
                f"{other.__module__}.{other.__qualname__} and {where}"
            )
        found[name] = implementation
    return dict(sorted(found.items()))


def _members(contract: type) -> set[str]:
    methods = {
        name
        for name, member in vars(contract).items()
        if not name.startswith("_")
        and (callable(member) or isinstance(member, (property, classmethod)))
    }
    return methods | set(contract.__annotations__)


def _public_classes(package: ModuleType) -> Iterator[type]:
    prefix = f"{package.__name__}."
    for info in sorted(pkgutil.walk_packages(package.__path__, prefix), key=lambda i: i.name):
        parts = info.name.removeprefix(prefix).split(".")
        if parts[-1].endswith("_kernel") or any(part.startswith("_") for part in parts):
            continue
        module = importlib.import_module(info.name)
        for name, member in inspect.getmembers(module, inspect.isclass):
            if not name.startswith("_") and member.__module__ == module.__name__:
                yield member
