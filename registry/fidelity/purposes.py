"""What a study is run for, and under which conditions of which data sets that is shown.

Purposes follow from a study's own attributes by the rules of `purposes.csv`: a compensation of the
Earth's light is shown under it, a calibration in operation on a sequence in orbit. What a data set
shows is read from it (`DataSet`): nothing here knows a study or a data set by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from registry.fidelity.particulars import Conditions, Purpose
from registry.studies import Facts, Study
from survey_data.json_data import JsonData

PURPOSES: Mapping[Purpose, str] = {
    "albedo": "under light from the Earth",
    "temperature": "at another temperature than at calibration",
    "flight": "on a sequence in orbit",
}
"""What a study can be run for, in words."""

#: Conditions that show a purpose on a sensor that does not fly.
_SHOWN = {"albedo": ("albedo",), "temperature": ("hot", "cold"), "flight": ()}
#: Columns that a flight must have to show it.
_COLUMNS = {"albedo": "albedo", "temperature": "temperature_K", "flight": "time_s"}


@dataclass(frozen=True)
class DataSet:
    """What the plan knows of a data set beside its architecture.

    `conditions` in order, the nominal one first; `context` its columns beside features; `follows`
    the keys of the studies that it is made after; `design` what its sensor is like, by the names of
    `registry.fidelity.evidence`.
    """

    name: str
    conditions: tuple[str, ...] = ("nominal",)
    context: frozenset[str] = frozenset()
    follows: tuple[str, ...] = ()
    design: Mapping[str, float | str] = field(default_factory=dict, hash=False)

    @property
    def flies(self) -> bool:
        """Whether its samples are a sequence in orbit."""
        return "time_s" in self.context

    def conditions_for(self, purpose: Purpose) -> tuple[str, ...]:
        """Return its conditions that show a purpose, the most telling first."""
        if self.flies:
            return self.conditions[:1] if _COLUMNS[purpose] in self.context else ()
        return tuple(name for name in _SHOWN[purpose] if name in self.conditions)


@dataclass(frozen=True)
class DatasetCondition(JsonData):
    """A data set under a condition, and the purposes of the study that it shows."""

    dataset: str
    condition: str
    purposes: tuple[Purpose, ...] = ()


def purposes(study: Study, facts: Facts) -> Mapping[Purpose, str]:
    """Return what a study is run for, with the rules that say so; empty for no special purpose."""
    found: dict[Purpose, str] = {}
    for row in facts.purposes:
        if _meets(study, row.given) and not (row.unless and _meets(study, row.unless)):
            found.setdefault(row.purpose, f"{row.id}: {row.rule}")
    return found


def settings(
    study: Study,
    wanted: Collection[Purpose],
    names: Iterable[str],
    data_sets: Mapping[str, DataSet],
    distance: Callable[[DataSet], float] = lambda _: 0.0,
) -> tuple[DatasetCondition, ...]:
    """Return where a pipeline stands for a study: data sets under conditions, the first one first.

    Those that show most of its purposes (`wanted`); among these data sets made after the study,
    then flights for a study with a purpose and benches for others, then what shows its first
    purpose, then by how far (`distance`) its sensor is from the study's, then by name. Where none
    shows any, the first condition of each. A data set that is missing in `data_sets` has a nominal
    condition alone.
    """
    known = [data_sets.get(name, DataSet(name)) for name in names]
    shown: dict[tuple[str, str], list[Purpose]] = {}
    for purpose in wanted:
        for one in known:
            for condition in one.conditions_for(purpose):
                shown.setdefault((one.name, condition), []).append(purpose)
    if not shown:
        shown = {(one.name, one.conditions[0]): [] for one in known}
    by_name = {one.name: one for one in known}
    order = tuple(wanted)

    def place(item: tuple[tuple[str, str], Sequence[Purpose]]) -> tuple[object, ...]:
        (name, condition), served = item
        one = by_name[name]
        return (
            -len(served),
            study.key not in one.follows,
            one.flies != bool(wanted),
            [order.index(purpose) for purpose in served],
            distance(one),
            name,
            one.conditions.index(condition),
        )

    ordered = sorted(shown.items(), key=place)
    return tuple(DatasetCondition(*at, tuple(served)) for at, served in ordered)


def _meets(study: Study, conditions: Conditions) -> bool:
    return all(value in study.of(attribute) for attribute, value in conditions)
