"""Compensations ahead of a model, by their classes: what is planned and scored under one name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self, cast

from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutModel,
    Compensation,
    Context,
    Extractor,
    FeatureKind,
    Floats,
    Model,
    SensorGeometry,
)
from algorithms.pipeline import Pipeline, make_stages


@dataclass(frozen=True)
class Chain:
    """A model behind compensations, to be made for a sensor as a model's class is.

    Parameters
    ----------
    compensations : tuple of class
        In the order they are applied, at least one.
    model : class
        That reads what they leave.

    Examples
    --------
    >>> from algorithms.compensations.optics.refraction import Refraction
    >>> from algorithms.models.non_physical.polynomial import SurfacePolynomial
    >>> chain = Chain((Refraction,), SurfacePolynomial)
    >>> chain.about.name, chain.about.taxonomy, chain.about.needs
    ('optical + polynomial-2d', 'OCM', ('focal_length_mm', 'cover_glass'))
    """

    compensations: tuple[type[Compensation], ...]
    model: type[Model]

    @cached_property
    def about(self) -> AboutModel:
        """What all its parts say together; the taxonomy is the first compensation's."""
        parts = [*(stage.about for stage in self.compensations), self.model.about]
        accepts = frozenset.intersection(*(part.accepts for part in parts))
        return AboutModel(
            name=" + ".join(part.name for part in parts),
            taxonomy=parts[0].taxonomy,
            studies=_unite(part.studies for part in parts),
            labels=_unite(part.labels for part in parts),
            origin="survey" if all(part.origin == "survey" for part in parts) else "ours",
            version=sum(part.version for part in parts) - len(parts) + 1,
            needs=_unite(part.needs for part in parts),
            accepts=accepts,
            context=_unite(part.context for part in parts),
        )

    @property
    def stages(self) -> tuple[type[Compensation | Model], ...]:
        """Its parts, in the order they are applied."""
        return (*self.compensations, self.model)

    def for_sensor(self, geometry: SensorGeometry, kind: FeatureKind) -> Model:
        """Return all parts unfitted; UnsuitableDesignError where one does not suit the sensor."""
        stages, behind = make_stages(self.compensations, geometry, kind)
        made = ChainModel(self.about, stages, self.model.for_sensor(behind, kind))
        return cast("Model", made)  # whose about is its own, not its class's

    def pipeline(self, extractor: type[Extractor], geometry: SensorGeometry) -> Pipeline:
        """Return all parts behind an extractor, as a user calibrates them and keeps them."""
        return Pipeline.for_sensor(extractor, self.model, geometry, self.compensations)


@dataclass
class ChainModel:
    """The parts of a `Chain` made for a sensor: fits and predicts as a model does.

    Parameters
    ----------
    about : AboutModel
        Of the chain.
    compensations : tuple of Compensation
        In the order they are applied.
    model : Model
        Behind them.
    """

    about: AboutModel
    compensations: tuple[Compensation, ...]
    model: Model

    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Fit every part to what those before it leave; returns self."""
        for stage in self.compensations:
            features = stage.fit(features, sun, context).transform(features, context)
        self.model.fit(features, sun, context)
        return self

    def predict(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """Sun unit vectors (N, 3); NaN rows where undefined."""
        for stage in self.compensations:
            features = stage.transform(features, context)
        return self.model.predict(features, context)


#: What a plan holds: a model alone, or one behind compensations.
Scored = type[Model] | Chain


def chains(
    compensations: Mapping[str, type[Compensation]], models: Mapping[str, type[Model]]
) -> dict[str, Chain]:
    """Every chain of a compensation and what it says it goes ahead of, by name.

    Parameters
    ----------
    compensations, models : mapping of str to class
        By name.

    Returns
    -------
    dict of str to Chain
        In alphabetical order.

    Raises
    ------
    ValueError
        If a compensation goes ahead of a model that there is not, or that reads other features.

    Examples
    --------
    >>> from algorithms.compensations.optics.refraction import Refraction
    >>> from algorithms.discovery import discover_models
    >>> list(chains({"optical": Refraction}, discover_models()))
    ['optical + lsq', 'optical + polynomial-2d', 'optical + spm']
    """
    found = {}
    for compensation in compensations.values():
        about = compensation.about
        for name in about.ahead_of:
            *between, last = name.split(" + ")
            if last not in models or not set(between) <= compensations.keys():
                raise ValueError(f"{about.name} goes ahead of {name}; there is no such model")
            chain = Chain((compensation, *(compensations[n] for n in between)), models[last])
            if not frozenset.intersection(*(stage.about.accepts for stage in chain.stages)):
                raise ValueError(f"{about.name} goes ahead of {name}, which reads other features")
            found[chain.about.name] = chain
    return dict(sorted(found.items()))


def _unite(words: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    """Every word once, in the order they come."""
    return tuple(dict.fromkeys(word for some in words for word in some))
