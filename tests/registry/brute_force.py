"""Answers by brute force: every architecture, report and pipeline, by the rules in words."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from registry.designs import gather
from registry.draws import BENCHES
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.requirements import CLASSES_DEG, MISSIONS, PARAMETERS
from registry.studies import Facts, Study
from survey_data.processors import factor
from survey_data.products import BuiltSensor, Product, built_sensors, products

Ask = Mapping[str, Any]
Pair = tuple[str, str]
Lists = defaultdict[Pair, list[Any]]
Measured = list[tuple[float, MeasuredPipeline]]
Users = Mapping[tuple[str, tuple[str, ...]], frozenset[str]]
OF_PRODUCTS = {"max_mass_g": "mass_g", "max_power_mw": "power_mw", "min_rate_hz": "update_hz"}
PARTS = {"model", "extractor", "exclude_model", "exclude_extractor", "properties"}
OF_STUDIES = {"task", "error", "exclude_task", "exclude_error"}
OF_SENSORS = {"detector", "mask", "exclude_detector", "exclude_mask"}
JUDGED = {*PARAMETERS, "sun_distance_au"} - OF_SENSORS


@dataclass(frozen=True)
class Report:
    """What one study, or one row of the table of hardware, says: numbers by requirement."""

    key: str
    family: str
    study: Study | None
    numbers: Mapping[str, float | None]
    classes: set[str]


def expanded(given: Ask) -> dict[str, Any]:
    """Return what is asked with the mission's own, and the hazard of the light at a distance."""
    ask = {**MISSIONS.get(given.get("mission", ""), {}), **given}
    distance = ask.get("sun_distance_au", 1.0)
    light = "saturation" if distance < 10**-0.25 else "noise" if distance > 10**0.25 else ""
    left = {*ask.get("accuracy", CLASSES_DEG)} - {*ask.get("exclude_accuracy", ())}
    classes = [CLASSES_DEG[name] for name in left] if len(left) < 4 else [(0.0, math.inf)]
    hazards = {*ask.get("tolerate", ()), light} - {""}
    return {**ask, "light": light, "hazards": hazards, "classes": classes}


def keeps(name: str, numbers: Iterable[float | None], limit: float) -> bool | None:
    known = [number for number in numbers if number is not None]
    return any((n >= limit if name[:3] == "min" else n <= limit) for n in known) if known else None


def of_product(product: Product, name: str) -> float | None:
    drawn = name != "max_power_mw" or product.supply != "self-powered"
    return getattr(product, OF_PRODUCTS[name]) if drawn else 0.0


class BruteForce:
    """Studies, products and pipelines of every architecture that one of them has."""

    def __init__(self, facts: Facts, measured: Measurements) -> None:
        self.facts = facts
        self.rows, self.studies, self.products = Lists(list), Lists(list), Lists(list)
        for row in measured.rows:
            self.rows[row.detector, row.mask].append(row)
        for study in facts.studies.values():
            for pair in study.architectures:
                self.studies[pair].append(study)
        for product in products():
            self.products[product.detector, product.mask].append(product)
        self.pairs = sorted({*self.rows, *self.studies, *self.products})
        self.reports = {pair: list(self._reports(pair)) for pair in self.pairs}
        self.designs = {
            place.architecture: {(one.extractor, one.stages): one.users for one in place.designs}
            for place in gather(facts, measured)
        }

    def _reports(self, pair: Pair) -> Iterator[Report]:
        rows = [row for row in built_sensors().values() if (row.detector, row.mask) == pair]
        mapped = {study.key for study in self.studies[pair]}
        for study in self.studies[pair]:
            yield self._report(study, [row for row in rows if row.study == study.key])
        others = [p.ids for p in self.products[pair] if not mapped & {*p.studies}]
        yield from (self._report(None, [built_sensors()[one]]) for ids in others for one in ids)

    def _report(self, study: Study | None, rows: list[BuiltSensor]) -> Report:
        said = study and study.report("accuracy")
        figures = (row.accuracy_rms_deg for row in rows if row.accuracy_rms_deg is not None)
        rms = said.rms_deg if said else next(figures, None)
        fields = (row.fov_full_deg for row in rows if row.fov_full_deg is not None)
        fov = (study and study.number("fov_deg")) or max(fields, default=None)
        found = {"max_error_deg": rms, "min_fov_deg": fov}
        for product in (p for p in products() for row in rows[:1] if row.id in p.ids):
            found |= {name: of_product(product, name) for name in OF_PRODUCTS}
        by_rms = [c for c, (a, b) in CLASSES_DEG.items() if rms is not None and a <= rms < b]
        classes = {*((study and study.of("accuracy")) or by_rms)}
        key, family = (study.key,) * 2 if study else (rows[0].id, rows[0].family)
        return Report(key, family, study, found, classes)

    def _fits(self, name: str, values: list[str], extractor: str, stages: Iterable[str]) -> bool:
        of = name.removeprefix("exclude_")
        if of == "properties":
            return all(self.facts.properties[one].get(extractor, 0) > 0 for one in values)
        wanted = {kind for value in values for kind in self.facts.taxonomy.kinds(of, value)}
        return wanted.isdisjoint(stages if of == "model" else [extractor]) == (name != of)

    def designs_with(self, ask: Ask, pair: Pair) -> Users:
        def fits(extractor: str, stages: tuple[str, ...]) -> bool:
            return all(self._fits(n, ask[n], extractor, stages) for n in PARTS & ask.keys())

        return {d: users for d, users in self.designs[pair].items() if fits(*d)}

    def study_has(self, ask: Ask, study: Study) -> bool:
        """Say whether a study has the tasks and errors asked for, and none that is excluded."""
        tasks, wanted = {*study.of("task")}, {*ask.get("task", ())}
        left = (tasks - {*ask.get("exclude_task", ())}) & (wanted or tasks)
        has, classes = {*study.of("error")}, {*study.of("accuracy")}
        out = [has & {*ask.get("exclude_error", ())}, classes & {*ask.get("exclude_accuracy", ())}]
        fits = not any(out) and ("error" not in ask or bool(has & {*ask["error"]}))
        return fits and (bool(left) or not (tasks or wanted))

    def in_scope(self, ask: Ask, pair: Pair) -> bool:
        for of, value in zip(("detector", "mask"), pair, strict=True):
            if value not in ask.get(of, [value]) or value in ask.get("exclude_" + of, ()):
                return False
        studies, included = self.studies[pair], [of for of in ("task", "error") if of in ask]
        free = not included and not (studies and OF_STUDIES & ask.keys())
        if free or any(self.study_has(ask, s) for s in studies):
            return True
        advice = [(a.requirement, a.value) for a in self.facts.advice if a.means(pair)]
        return bool(included) and all(any((n, v) in advice for v in ask[n]) for n in included)

    def built_keeps(self, ask: Ask, pair: Pair, name: str) -> bool | None:
        return keeps(name, [of_product(one, name) for one in self.products[pair]], ask[name])

    def report_state(self, ask: Ask, pair: Pair, one: Report, name: str) -> bool | None:
        if name in {"max_error_deg", "min_fov_deg", *OF_PRODUCTS}:
            said = keeps(name, [one.numbers.get(name)], ask[name])
            ask_products = said is None and name in OF_PRODUCTS
            return self.built_keeps(ask, pair, name) if ask_products else said
        if name.endswith("accuracy"):
            has = bool(one.classes & {*ask[name]})
            return not has if name == "exclude_accuracy" else has if one.classes else None
        if name == "sun_distance_au":
            return None if ask["light"] else True
        if one.study is None or name not in PARTS | OF_STUDIES:
            return None
        if name in PARTS:
            return any(one.key in users for users in self.designs_with(ask, pair).values())
        return self.study_has(ask, one.study)

    def report_meets(self, ask: Ask, pair: Pair, one: Report) -> bool:
        states = {name: self.report_state(ask, pair, one, name) for name in ask.keys() & JUDGED}
        return all(said or (said is None and n in OF_PRODUCTS) for n, said in states.items())

    def pipelines(self, ask: Ask, pair: Pair) -> Iterator[tuple[float, MeasuredPipeline]]:
        """Yield the measured pipelines that meet all, each with the error that orders them."""
        half = ask["min_fov_deg"] / 2 if "min_fov_deg" in ask else None
        bench, designs, errors = ask.get("bench_deg"), self.designs_with(ask, pair), []
        for row in self.rows[pair]:
            own = row.judge(ask["hazards"], half).error_deg
            if (row.extractor_taxonomy, row.stages) in designs and math.isfinite(own):
                draws = [own * ratio for ratio in row.unit_ratios]
                if bench is not None:
                    draws = [math.hypot(unit, bench * b) for unit in draws for b in BENCHES]
                share = ask.get("confidence", 0.9)
                kept = sorted(draws)[math.ceil(share * len(draws) - 1e-9) - 1]
                errors.append((kept, own if bench is None else kept, row))
        best = min((kept for kept, _, _ in errors), default=math.inf)
        yield from ((e, row) for kept, e, row in errors if self._keeps(ask, pair, row, kept, best))

    def _keeps(self, ask: Ask, pair: Pair, row: MeasuredPipeline, kept: float, best: float) -> bool:
        numbers = {
            "max_error_deg": kept,
            "min_availability": row.availability(ask["hazards"]),
            "max_latency_us": row.latency_us and row.latency_us * factor(ask.get("processor")),
        }
        states = [keeps(name, [n], ask[name]) for name, n in numbers.items() if name in ask]
        built = [self.built_keeps(ask, pair, name) for name in OF_PRODUCTS if name in ask]
        if not all(states) or False in built or not all(map(row.covers, ask["hazards"])):
            return False
        is_class = any(a <= best and kept < b for a, b in ask["classes"])
        return is_class and not {*row.needs} & {*ask.get("exclude_needs", ())}

    def answer(self, given: Ask) -> dict[Pair, tuple[list[Report], Measured]]:
        """Return the reports and pipelines that meet all, of every architecture in the answer."""
        ask, found = expanded(given), {}
        for pair in self.pairs:
            if self.in_scope(ask, pair):
                reports = [r for r in self.reports[pair] if self.report_meets(ask, pair, r)]
                measured = list(self.pipelines(ask, pair))
                has = {"reported": reports, "measured": measured, "both": reports and measured}
                if has.get(ask.get("evidence", "any"), reports or measured):
                    found[pair] = (reports, measured)
        return found
