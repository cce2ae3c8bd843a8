"""Compensations put together as studies put them together, beyond what each goes ahead of itself.

A compensation names the models that it is planned ahead of (`ahead_of`). A study may have put it
ahead of another, or several compensations one after the other; those pipelines stand here by name,
with the studies that used them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from algorithms.about import AboutModel
from algorithms.chain import Chain
from algorithms.contract import Compensation, Model

#: What is planned of a combination of spots: behind one shape of opening, round or square. One with
#: a model of slits is planned behind these.
OPENING = ("aperture_shape",)


@dataclass(frozen=True)
class Combination(Chain):
    """A chain that studies used, planned only for sensors whose drawing has what it needs.

    Parameters
    ----------
    compensations, model
        See `algorithms.chain.Chain`.
    used_by : tuple of str
        Keys of the studies.
    needs : tuple of str
        Fields of `SensorGeometry` beside those that its parts need.

    Examples
    --------
    >>> from algorithms.discovery import discover_chains
    >>> discover_chains()["optical + lut"].about.needs
    ('focal_length_mm', 'cover_glass', 'aperture_shape')
    """

    used_by: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()

    @cached_property
    def about(self) -> AboutModel:
        """What its parts say together, the studies that used it and what else it needs."""
        parts = Chain(self.compensations, self.model).about
        return replace(
            parts,
            studies=tuple(dict.fromkeys((*parts.studies, *self.used_by))),
            needs=tuple(dict.fromkeys((*parts.needs, *self.needs))),
        )


#: Combinations by name, each with the studies that used it.
USED: Mapping[str, tuple[str, ...]] = {
    "optical + lut": ("Delgado2011", "Delgado2012a", "Delgado2012b", "Delgado2013", "Ortega2009"),
    "optical + multi-slit": ("Enright2007a",),
}


def combinations(
    compensations: Mapping[str, type[Compensation]],
    models: Mapping[str, type[Model]],
    used: Mapping[str, Iterable[str]] = USED,
) -> dict[str, Combination]:
    """Every combination that is used, made of the parts that its name says.

    Parameters
    ----------
    compensations, models : mapping of str to class
        By name.
    used : mapping of str to str
        Studies by the combination's name: compensations in their order and a model, `` + ``
        between them.

    Returns
    -------
    dict of str to Combination
        In alphabetical order.

    Raises
    ------
    ValueError
        If a part does not exist, or the parts read different features.
    """
    found = {}
    for name, studies in sorted(used.items()):
        *stages, last = name.split(" + ")
        unknown = [part for part in stages if part not in compensations]
        unknown += [last] * (last not in models)
        if unknown or not stages:
            raise ValueError(
                f"a combination names compensations and a model; of {name!r} "
                f"{', '.join(unknown) or 'no part'} is {'none' if unknown else 'a compensation'}"
            )
        model = models[last]
        needs = () if "slits" in model.about.needs else OPENING
        made = Combination(
            tuple(compensations[part] for part in stages), model, tuple(studies), needs
        )
        if not frozenset.intersection(*(stage.about.accepts for stage in made.stages)):
            raise ValueError(f"the parts of {name!r} read different features")
        found[name] = made
    return found
