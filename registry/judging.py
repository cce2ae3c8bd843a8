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

from registry.design_table import DesignTable, Flags, Numbers, PipelineErrors, Positions
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


#: Names of the requirements on what a question finds.
_ARCHITECTURE = ("detector", "mask", "exclude_detector", "exclude_mask")
PARTS = ("model", "extractor", "exclude_model", "exclude_extractor", "properties")
#: Those that a measured pipeline can meet or miss.
_MEASURED = (
    *("max_error_deg", "accuracy", "exclude_accuracy"),
    *("min_fov_deg", "tolerate", "sun_distance_au"),
    *("min_availability", "max_latency_us", "exclude_needs"),
)


class Question:
    """Requirements applied to a table of designs."""

    def __init__(self, table: DesignTable, requirements: Requirements) -> None:
        self.table = table
        self.requirements = requirements

    @cached_property
    def errors(self) -> PipelineErrors:
        """Own errors of all pipelines under the required hazards and field."""
        return self.table.errors(self.requirements.hazards, self.requirements.half_field_deg)

    @cached_property
    def candidates(self) -> Flags:
        """Pipelines of the required designs on the required architectures."""
        return self.designs[self.table.row_design] & self.places[self.table.row_place]

    @cached_property
    def judged_deg(self) -> Numbers:
        """Error that a limit is compared with: kept by the share of units (and stated benches)."""
        table, asked, own = self.table, self.requirements, self.errors.own_error_deg
        found = np.where(self.candidates, table.within(own, slice(None), None, asked.share), np.inf)
        if not asked.bench_deg:
            return found
        among = np.isfinite(found)
        if asked.largest_deg is not None:  # what misses without a bench misses with one
            among &= found <= asked.largest_deg
        found[~among] = np.inf
        found[among] = table.within(own, among, asked.bench_deg, asked.share)
        return found

    def judged_alone_deg(self, row: int) -> float:
        """Return the same of one pipeline, also where it misses without a bench."""
        own, asked = self.errors.own_error_deg, self.requirements
        if math.isfinite(self.judged_deg[row]):
            return float(self.judged_deg[row])
        return float(self.table.within(own, [row], asked.bench_deg, asked.share)[0])

    @cached_property
    def shown_deg(self) -> Numbers:
        """Error that pipelines are ordered by: on the stated bench, else the own error."""
        is_stated = self.requirements.bench_deg is not None
        return self.judged_deg if is_stated else self.errors.own_error_deg

    @cached_property
    def by_pipeline(self) -> Mapping[str, States]:
        """State of each measured pipeline for every requirement that measurement can judge."""
        names = [name for name in self._judged_names if name in _MEASURED]
        return {name: self._by_pipeline(name) for name in names}

    def _by_pipeline(self, name: str) -> States:
        errors, limit = self.errors, self.requirements.value_of(name)
        answered = np.isfinite(errors.own_error_deg)
        known: Flags | bool = True
        if name == "max_error_deg":
            meets, known = self.judged_deg <= limit, answered | errors.covers
        elif name == "accuracy":
            meets, known = self._in_classes(limit), answered
        elif name == EXCLUDE + "accuracy":
            meets, known = self._in_classes(CLASSES_DEG.keys() - {*limit}), answered
        elif name == "min_fov_deg":
            meets = np.isfinite(errors.nominal_deg)
        elif name == "min_availability":
            meets, known = errors.availability >= limit, ~np.isnan(errors.availability)
        elif name == "max_latency_us":
            time = self.table.latency_us * factor(self.requirements.processor)
            meets, known = time <= limit, ~np.isnan(time)
        elif name == "exclude_needs":
            meets = ~np.logical_or.reduce([self.table.needs_input[need] for need in limit])
        else:
            meets, known = answered, errors.covers
        return _states(meets, known)

    @cached_property
    def by_report(self) -> Mapping[str, States]:
        """State of each report for every requirement but detector and mask."""
        return {name: self._by_report(name) for name in self._judged_names}

    def _by_report(self, name: str) -> States:
        table, attribute = self.table, name.removeprefix(EXCLUDE)
        if attribute in OF_STUDIES:
            return _states(self._studies_alone(name)[table.report_study], table.report_study >= 0)
        if attribute == "accuracy":
            classes = table.report_classes
            named = np.logical_or.reduce([classes[one] for one in self.requirements.value_of(name)])
            known = np.logical_or.reduce([*classes.values()])
            return _states(named, known) if name == attribute else _states(~named)
        if name in PARTS:
            return self._with_parts
        if name not in REPORTED:
            return np.zeros(len(table.reports), np.int8)
        found = _states(*self._within(name))
        if name in OF_PRODUCTS:  # what is built tells of studies on the same that state nothing
            found = np.where(found == UNKNOWN, self.by_place[name][table.report_place], found)
        return found

    @cached_property
    def _judged_names(self) -> list[str]:
        """Requirements on reports or pipelines: all but those on detector and mask.

        Nor a distance from the Sun whose light is nearest to that of 1 au.
        """
        light, names = self.requirements.light, self.requirements.names
        passed = () if light is None or light.hazard else ("sun_distance_au",)
        return [name for name in names if name not in (*_ARCHITECTURE, *passed)]

    @cached_property
    def _with_parts(self) -> States:
        """State of each report for model, extractor and properties: those that its study uses."""
        table, study = self.table, self.table.report_study
        design, user = table.uses
        kept = self.designs[design]
        meets = np.zeros((len(table.places), len(table.keys)), bool)
        meets[table.design_place[design[kept]], user[kept]] = True
        return _states(meets[table.report_place, study], study >= 0)

    def _within(self, name: str) -> tuple[Flags, Flags]:
        """Return which reports keep a limit on a number, and which state the number."""
        column, at_most = REPORTED[name]
        values, limit = self.table.report_numbers[column], self.requirements.value_of(name)
        known = ~np.isnan(values)
        return (values <= limit if at_most else values >= limit) & known, known

    @cached_property
    def by_place(self) -> Mapping[str, States]:
        """State of each architecture for mass, power and rate, by all that is built of it."""
        asked = [name for name in OF_PRODUCTS if self.requirements.value_of(name) is not None]
        return {name: self._by_place(name) for name in asked}

    def _by_place(self, name: str) -> States:
        kept, known = self._within(name)
        place = self.table.report_place
        return _states(self._places_with(place[kept]), self._places_with(place[known]))

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
        found = self.candidates & np.isfinite(self.errors.own_error_deg)
        for states in self.by_pipeline.values():
            found &= states == MEETS
        for states in self.by_place.values():
            found &= states[self.table.row_place] >= UNKNOWN
        return found

    @cached_property
    def measured_places(self) -> Flags:
        """Architectures with a measured pipeline that meets all requirements."""
        return self._places_with(self.table.row_place[self.measured])

    @cached_property
    def matching_places(self) -> Flags:
        """Architectures that the evidence asked for brings into the answer."""
        table, measured = self.table, self.measured_places
        reported = self._places_with(table.report_place[self.reported])
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
        found |= ~table.is_measured & (table.used & counting[table.design_place]).any(axis=1)
        return found & self.designs & self.matching_places[table.design_place]

    def bench_for(self, rows: Sequence[int]) -> float | None:
        """Return the bench error up to which one of some pipelines keeps the limit.

        Rounded down to two digits, so that a bench of that error does. None without a limit, or
        where none of them has an error.
        """
        limit, own = self.requirements.largest_deg, self.errors.own_error_deg[rows]
        if limit is None or not np.isfinite(own).any():
            return None
        needed = bench_for(own, self.table.unit_ratios[rows], limit, self.requirements.share)
        return float(_TWO_DIGITS.create_decimal(float(needed.max())))

    def _places_with(self, place: Positions) -> Flags:
        found = np.zeros(len(self.table.places), bool)
        found[place] = True
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

    @cached_property
    def designs(self) -> Flags:
        """Designs that have the required parts."""
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

    @cached_property
    def studies(self) -> Flags:
        """Studies with the required tasks and errors, none of which is excluded."""
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

    @cached_property
    def places(self) -> Flags:
        """Architectures that a study with the tasks and errors has, or advice means."""
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


def _states(meets: Flags, known: Flags | bool = True) -> States:
    """Return states of what meets, misses or (where not known) leaves unknown."""
    return np.subtract(meets & known, ~meets & known, dtype=np.int8)
