"""Requirements put to the table of designs: what reports meet, and what measured pipelines do.

Of each requirement a report or a pipeline *meets*, *misses* or leaves it *unknown*. The two kinds
of evidence are judged apart, and neither stands in for the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from decimal import ROUND_FLOOR, Context
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.design_table import DesignTable, Flags, Numbers, PipelineErrors
from registry.draws import bench_for
from registry.requirements import CLASSES_DEG, EXCLUDE, OF_PRODUCTS, OF_STUDIES, Requirements
from survey_data.processors import factor

States = NDArray[np.int8]
MEETS, UNKNOWN, MISSES = 1, 0, -1

_TWO_DIGITS = Context(prec=2, rounding=ROUND_FLOOR)

_OF_DESIGNS = ("detector", "mask", "model", "extractor")
#: Limits on a reported number, and whether it must be at most or at least that.
REPORTED = {
    "max_error_deg": ("rms_deg", True),
    "min_fov_deg": ("fov_deg", False),
    "max_mass_g": ("mass_g", True),
    "max_power_mw": ("power_mw", True),
    "min_rate_hz": ("rate_hz", False),
}


class Question:
    """Requirements applied to a table of designs.

    Attributes
    ----------
    table, requirements : what is asked of what
    like : a question of the same table whose errors may be the same
    designs : designs that have the required parts
    studies : studies with the required tasks and errors, none of which is excluded
    places : architectures that one of these has, or that the survey advises for them
    """

    def __init__(
        self, table: DesignTable, requirements: Requirements, like: Question | None = None
    ) -> None:
        self.table = table
        self.requirements = requirements
        self.designs = self._find_designs()
        self.studies = self._find_studies()
        self.places = self._find_places()
        self._like = like

    def relaxed(self, requirements: Requirements) -> Question:
        """Return other requirements put to the same table; errors are shared where they can be."""
        return Question(self.table, requirements, self)

    @cached_property
    def errors(self) -> PipelineErrors:
        """Own errors of all pipelines under the required hazards and field."""
        like, asked = self._like, self.requirements
        if like is not None and (
            (like.requirements.hazards, like.requirements.half_field_deg)
            == (asked.hazards, asked.half_field_deg)
        ):
            return like.errors
        return self.table.errors(self.requirements.hazards, self.requirements.half_field_deg)

    @cached_property
    def candidates(self) -> Flags:
        """Pipelines of the required designs on the required architectures."""
        return self.designs[self.table.row_design] & self.places[self.table.row_place]

    @cached_property
    def judged_deg(self) -> Numbers:
        """Error that a limit is compared with: kept by the share of units (and stated benches)."""
        own, asked = self.errors.own_deg, self.requirements
        among = self.candidates & np.isfinite(own)
        found = np.full(len(own), np.inf)
        found[among] = self.table.within(own, among, None, asked.share)
        if not asked.bench_deg:
            return found
        if asked.largest_deg is not None:  # what misses without a bench misses with one
            among &= found <= asked.largest_deg
        known = self.errors.on_bench.setdefault((asked.bench_deg, asked.share), found * np.nan)
        new = among & np.isnan(known)
        known[new] = self.table.within(own, new, asked.bench_deg, asked.share)
        return np.where(among, known, np.inf)

    def judged_alone_deg(self, row: int) -> float:
        """Return the same of one pipeline, also where it misses without a bench."""
        own, asked = self.errors.own_deg, self.requirements
        if math.isfinite(self.judged_deg[row]):
            return float(self.judged_deg[row])
        return float(self.table.within(own, [row], asked.bench_deg, asked.share)[0])

    @cached_property
    def shown_deg(self) -> Numbers:
        """Error that pipelines are ordered by: on the stated bench, else the own error."""
        is_stated = self.requirements.bench_deg is not None
        return self.judged_deg if is_stated else self.errors.own_deg

    @cached_property
    def by_pipeline(self) -> Mapping[str, States]:
        """State of each measured pipeline for every requirement that measurement can judge."""
        table, asked, errors = self.table, self.requirements, self.errors
        answered = np.isfinite(errors.own_deg)
        found: dict[str, States] = {}
        if asked.max_error_deg is not None:
            found["max_error_deg"] = _states(self.judged_deg <= asked.max_error_deg, answered)
            found["max_error_deg"][~answered & errors.covers] = MISSES
        if "accuracy" in asked.include:
            found["accuracy"] = _states(self._in_classes(asked.include["accuracy"]), answered)
        if "accuracy" in asked.exclude:
            left = CLASSES_DEG.keys() - {*asked.exclude["accuracy"]}
            found[EXCLUDE + "accuracy"] = _states(self._in_classes(left), answered)
        if asked.min_fov_deg is not None:
            found["min_fov_deg"] = _states(np.isfinite(errors.nominal_deg))
        for name in ("survive", "sun_distance_au"):
            if asked.survive if name == "survive" else asked.light and asked.light.hazard:
                found[name] = _states(answered, errors.covers)
        if asked.min_availability is not None:
            known = ~np.isnan(errors.availability)
            found["min_availability"] = _states(
                errors.availability >= asked.min_availability, known
            )
        if asked.max_latency_us is not None:
            time = table.latency_us * factor(asked.processor)
            found["max_latency_us"] = _states(time <= asked.max_latency_us, ~np.isnan(time))
        if asked.exclude_needs:
            needs = [table.needs_input[need] for need in asked.exclude_needs]
            found["exclude_needs"] = _states(~np.logical_or.reduce(needs))
        return found

    @cached_property
    def by_report(self) -> Mapping[str, States]:
        """State of each report for every requirement but detector and mask."""
        table, asked = self.table, self.requirements
        is_study, study = table.report_study >= 0, table.report_study
        found: dict[str, States] = {}
        for side, prefix in ((asked.include, ""), (asked.exclude, EXCLUDE)):
            for name in (one for one in OF_STUDIES if one in side):
                meets = self._studies_alone(prefix + name)
                found[prefix + name] = _states(meets[study], is_study)
        classes = table.report_classes
        if "accuracy" in asked.include:
            named = np.logical_or.reduce([classes[name] for name in asked.include["accuracy"]])
            found["accuracy"] = _states(named, np.logical_or.reduce([*classes.values()]))
        if "accuracy" in asked.exclude:
            named = np.logical_or.reduce([classes[name] for name in asked.exclude["accuracy"]])
            found[EXCLUDE + "accuracy"] = _states(~named)
        if names := self.of_parts:
            design, user = table.uses
            kept = self.designs[design]
            meets = np.zeros((len(table.places), len(table.keys)), bool)
            meets[table.design_place[design[kept]], user[kept]] = True
            states = _states(meets[table.report_place, study], is_study)
            found |= dict.fromkeys(names, states)
        found |= {n: self._reports_within(n) for n in REPORTED if asked.value_of(n) is not None}
        untold = ("min_availability", "max_latency_us", "survive", "exclude_needs")
        silent = [name for name in untold if asked.value_of(name) is not None]
        if asked.light and asked.light.hazard:
            silent.append("sun_distance_au")
        return found | {name: np.zeros(len(table.reports), np.int8) for name in silent}

    def _reports_within(self, name: str) -> States:
        """Return the state of each report for a limit; products tell of studies without one."""
        found = _states(*self._within(name))
        if name not in OF_PRODUCTS:
            return found
        return np.where(found == UNKNOWN, self.by_place[name][self.table.report_place], found)

    def _within(self, name: str) -> tuple[Flags, Flags]:
        """Return which reports keep a limit on a number, and which state the number."""
        column, at_most = REPORTED[name]
        values, limit = self.table.report_numbers[column], self.requirements.value_of(name)
        assert isinstance(limit, float | int)  # noqa: S101 - only limits asked for are looked at
        known = ~np.isnan(values)
        return (values <= limit if at_most else values >= limit) & known, known

    @cached_property
    def by_place(self) -> Mapping[str, States]:
        """State of each architecture for mass, power and rate, by all that is built of it."""
        asked = [name for name in OF_PRODUCTS if self.requirements.value_of(name) is not None]
        found = {}
        for name in asked:
            kept, known = self._within(name)
            found[name] = _states(self._any_report(kept), self._any_report(known))
        return found

    @cached_property
    def reported(self) -> Flags:
        """Reports that meet all requirements; of mass, power and rate unknown is enough."""
        table = self.table
        found = self.places[table.report_place] & self._architectures[table.report_place]
        for name, states in self.by_report.items():
            found &= states >= (UNKNOWN if name in OF_PRODUCTS else MEETS)
        return found

    @cached_property
    def measured(self) -> Flags:
        """Measured pipelines that meet all requirements; unknown mass, power and rate is enough."""
        found = self.candidates & np.isfinite(self.errors.own_deg)
        for states in self.by_pipeline.values():
            found &= states == MEETS
        for states in self.by_place.values():
            found &= states[self.table.row_place] >= UNKNOWN
        return found

    @cached_property
    def measured_places(self) -> Flags:
        """Architectures with a measured pipeline that meets all requirements."""
        found = np.zeros(len(self.table.places), bool)
        found[self.table.row_place[self.measured]] = True
        return found

    @cached_property
    def matching_places(self) -> Flags:
        """Architectures that the evidence asked for brings into the answer."""
        reported, measured = self._any_report(self.reported), self.measured_places
        kinds = {"reported": reported, "measured": measured, "both": reported & measured}
        return kinds.get(self.requirements.evidence or "any", reported | measured)

    @cached_property
    def matching_designs(self) -> Flags:
        """Designs with a pipeline that meets all, or unmeasured and used by a study that does."""
        table = self.table
        found = np.zeros(len(table.designs), bool)
        found[table.row_design[self.measured]] = True
        counting = np.zeros((len(table.places), len(table.keys)), bool)
        of_studies = self.reported & (table.report_study >= 0)
        counting[table.report_place[of_studies], table.report_study[of_studies]] = True
        found |= self.unmeasured & (table.used & counting[table.design_place]).any(axis=1)
        return found & self.designs & self.matching_places[table.design_place]

    @cached_property
    def unmeasured(self) -> Flags:
        """Designs without any measured pipeline."""
        found = np.ones(len(self.table.designs), bool)
        found[self.table.row_design] = False
        return found

    def bench_for(self, rows: Sequence[int]) -> float | None:
        """Return the bench error up to which one of some pipelines keeps the limit.

        Rounded down to two digits, so that a bench of that error does. None without a limit, or
        where none of them has an error.
        """
        limit, own = self.requirements.largest_deg, self.errors.own_deg[rows]
        if limit is None or not np.isfinite(own).any():
            return None
        needed = bench_for(own, self.table.unit_ratios[rows], limit, self.requirements.share)
        return float(_TWO_DIGITS.create_decimal(float(needed.max())))

    def _any_report(self, among: Flags) -> Flags:
        found = np.zeros(len(self.table.places), bool)
        found[self.table.report_place[among]] = True
        return found

    @cached_property
    def _architectures(self) -> Flags:
        """Architectures with the required detector and mask."""
        table, asked = self.table, self.requirements
        found = np.ones(len(table.places), bool)
        for at, name in enumerate(("detector", "mask")):
            for side, wanted in ((asked.include, True), (asked.exclude, False)):
                if name in side:
                    has = [(one.architecture[at] in side[name]) == wanted for one in table.places]
                    found &= np.array(has, bool)
        return found

    @property
    def of_parts(self) -> tuple[str, ...]:
        """Names of the requirements on model, extractor and its properties."""
        names = ("model", "extractor", "exclude_model", "exclude_extractor", "properties")
        return tuple(name for name in names if self.requirements.value_of(name) is not None)

    def _in_classes(self, classes: Iterable[str]) -> Flags:
        """Say of each pipeline whether it and the best one of its sensor are of a class."""
        table, judged = self.table, self.judged_deg
        best = np.full(len(table.places), np.inf)
        np.minimum.at(best, table.row_place, judged)
        found = np.zeros(len(judged), bool)
        for name in classes:
            least, most = CLASSES_DEG[name]
            is_class = (best >= least) & (best < most)
            found |= is_class[table.row_place] & (judged < most)
        return found

    def _find_designs(self) -> Flags:
        table, asked = self.table, self.requirements
        found = np.ones(len(table.designs), bool)
        for side, wanted in ((asked.include, True), (asked.exclude, False)):
            for attribute in (name for name in _OF_DESIGNS if name in side):
                found &= table.designs_with(attribute, side[attribute]) == wanted
        if asked.properties:
            marks = [table.facts.properties[name] for name in asked.properties]
            extractors = {design.extractor for design in table.designs}
            found &= table.designs_with(
                "extractor", [e for e in extractors if all(of.get(e, 0) for of in marks)]
            )
        return found

    def _find_studies(self) -> Flags:
        found = np.ones(len(self.table.keys), bool)
        for prefix, side in (("", self.requirements.include), (EXCLUDE, self.requirements.exclude)):
            for name in (one for one in OF_STUDIES if one in side):
                found &= self._studies_alone(prefix + name)
        if "accuracy" in self.requirements.exclude:
            found &= ~self.table.studies_with("accuracy", self.requirements.exclude["accuracy"])
        return found

    def _studies_alone(self, name: str) -> Flags:
        """Return the studies that meet one of the requirements on studies."""
        table, asked = self.table, self.requirements
        attribute = name.removeprefix(EXCLUDE)
        if not name.startswith(EXCLUDE):
            return table.studies_with(attribute, asked.include[attribute])
        excluded = asked.exclude[attribute]
        if attribute != "task":
            return ~table.studies_with(attribute, excluded)
        tasks = set(table.facts.taxonomy.values("task"))
        wanted = set(asked.include.get("task", tasks)) - {*excluded}
        return table.studies_with("task", wanted) | ~table.studies_with("task", tasks)

    def _find_places(self) -> Flags:
        """Return the architectures that a study with the tasks and errors has, or advice means."""
        table, asked = self.table, self.requirements
        include = [name for name in OF_STUDIES if name in asked.include]
        if not include and not any(name in asked.exclude for name in OF_STUDIES):
            return self._architectures
        found = (table.place_studies & self.studies).any(axis=1)
        if include:
            found |= np.logical_and.reduce(
                [table.advised_for(name, asked.include[name]) for name in include]
            )
        else:
            found |= ~table.place_studies.any(axis=1)
        return found & self._architectures


def _states(meets: Flags, known: Flags | None = None) -> States:
    """Return states of what meets, misses or (where not known) leaves unknown."""
    found = np.where(meets, MEETS, MISSES).astype(np.int8)
    if known is not None:
        found[~known] = UNKNOWN
    return found
