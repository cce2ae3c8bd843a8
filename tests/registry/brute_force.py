"""Answers by brute force over studies and pipelines, and what to draw them from."""

import itertools
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from hypothesis import strategies as st

from registry.measured_pipelines import MeasuredPipeline, Score
from registry.recommendation import Calibration
from registry.studies import Facts, Study

LEVELS = ("task", "detector", "mask", "model", "extractor")
VALUES = {
    "task": ["Accuracy", "Cost"],
    "error": ["Optical", "Alignment"],
    "accuracy": ["FSS", "CSS"],
    "detector": ["CMOS", "PD"],
    "mask": ["Slit", "Lens"],
    "model": ["SPM", "OCM", "ECM", "ECM/Noise"],
    "extractor": ["BCTM", "Direct"],
    "accuracy_deg": ["0.01", "0.5", "2"],
    "fov_deg": ["60", "120"],
}
COMPENSATING = {"OCM", "ECM", "ECM/Noise"}
Rows = list[Mapping[str, list[str]]]
rows = st.lists(
    st.fixed_dictionaries(
        {
            a: st.lists(
                st.sampled_from(v),
                max_size=1 if a.endswith("_deg") else 2,
                min_size=1 if a in LEVELS else 0,
                unique=True,
            )
            for a, v in VALUES.items()
        }
    ),
    min_size=1,
    max_size=5,
)
numbers = st.sampled_from([0.005, 0.01, 0.3, 1.0])
cones = st.sampled_from([(), ((20.0, 0.002), (60.0, None)), ((20.0, None), (60.0, 0.2))])


def scores(condition: str) -> st.SearchStrategy[Score]:
    return st.builds(
        Score,
        condition=st.just(condition),
        rms_deg=st.none() | numbers,
        availability=st.sampled_from([0.4, 0.5, 0.97, 1.0]),
        is_available=st.booleans(),
        cones=cones,
    )


pipelines = st.lists(
    st.builds(
        MeasuredPipeline,
        dataset=st.sampled_from(["d1", "d2"]),
        detector=st.sampled_from(VALUES["detector"]),
        mask=st.sampled_from(VALUES["mask"]),
        extractor=st.sampled_from(["e", "f"]),
        extractor_taxonomy=st.sampled_from(VALUES["extractor"]),
        model=st.sampled_from(["m", "n"]),
        stages=st.sampled_from([("SPM",), ("ECM/Noise",), ("OCM", "SPM")]),
        nominal=scores("nominal"),
        hazards=st.dictionaries(
            st.sampled_from(["albedo", "spin"]), scores("bad").map(lambda s: (s,)), max_size=2
        ),
        half_fov_deg=st.none() | st.sampled_from([20.0, 60.0]),
        latency_us=st.none() | st.sampled_from([1.0, 10.0]),
    ),
    max_size=8,
    unique_by=lambda row: (row.dataset, row.extractor, row.model),
)
to_ask = {
    **{
        prefix + a: st.lists(st.sampled_from(VALUES[a]), min_size=1, max_size=2, unique=True)
        for prefix in ("", "exclude_")
        for a in VALUES
        if not a.endswith("_deg")
    },
    "max_error_deg": st.sampled_from([0.004, 0.01, 0.5, 3.0]),
    "min_fov_deg": st.sampled_from([30.0, 50.0, 120.0, 200.0]),
    "max_latency_us": st.sampled_from([0.5, 5.0, 50.0]),
    "min_availability": st.sampled_from([0.4, 0.9, 1.0]),
    "survive": st.lists(st.sampled_from(["albedo", "spin", "glare"]), min_size=1, unique=True),
}
asked = st.lists(st.sampled_from(list(to_ask)), max_size=5, unique=True).flatmap(
    lambda names: st.fixed_dictionaries({name: to_ask[name] for name in names})
)
Ask = dict[str, object]
Pair = tuple[str, str]
Designed = dict[tuple[str, tuple[str, ...]], list[MeasuredPipeline]]


def kinds(values: Iterable[str]) -> set[str]:
    return {k for v in values for k in ((v, "ECM/Noise") if v == "ECM" else (v,))}


def wanted(ask: Ask, name: str) -> list[str]:
    values = ask.get(name, [])
    assert isinstance(values, list)
    return values


def number(ask: Ask, name: str) -> float | None:
    value = ask.get(name)
    assert value is None or isinstance(value, float)
    return value


def has_what_is_asked(study: Study, ask: Ask) -> bool:
    for attribute in ("task", "error", "accuracy"):
        values, out = set(study.of(attribute)), set(wanted(ask, "exclude_" + attribute))
        included = wanted(ask, attribute)
        if attribute == "task":  # another task is enough
            left = (values - out) & (set(included) or values)
            if not left and (values or included):
                return False
        elif values & out or (included and not values & set(included)):
            return False
    return True


def stands_for(study: Study, stages: tuple[str, ...]) -> bool:
    models = kinds(study.of("model"))
    if not set(stages[:-1]) <= models:
        return False
    compensates = bool(stages[:-1]) and set(study.of("model")) <= COMPENSATING
    return stages[-1] in models or compensates


def states(study: Study, ask: Ask) -> bool:
    """Whether a study's own numbers keep the limits; none tells of the others."""
    if any(name in ask for name in ("max_latency_us", "min_availability", "survive")):
        return False
    largest, field = number(ask, "max_error_deg"), number(ask, "min_fov_deg")
    error, fov = study.number("accuracy_deg"), study.number("fov_deg")
    kinds = {"3sigma": 3.0, "max": 3.0, "1sigma": 1.0, "rms": 1.0, "p95": 1.96, "mean": 0.7979}
    if error is not None:
        error /= kinds.get(next(iter(study.of("accuracy_kind")), ""), 1.0)
    return (largest is None or (error is not None and error <= largest)) and (
        field is None or (fov is not None and fov >= field)
    )


def error_over(row: MeasuredPipeline, score: Score, full_field: float | None) -> float:
    if full_field is not None:
        for half, error in score.cones:
            if 2 * half >= full_field and error is not None:
                return error
        if row.half_fov_deg is None or 2 * row.half_fov_deg < full_field:
            return math.inf
    return math.inf if score.rms_deg is None or not score.is_available else score.rms_deg


def error_of(row: MeasuredPipeline, ask: Ask) -> float | None:
    """The error that a pipeline is judged by; None if it breaks a limit."""
    hazards = wanted(ask, "survive")
    tried = [row.nominal, *(s for name in hazards for s in row.hazards.get(name, ()))]
    full = number(ask, "min_fov_deg")
    errors = [error_over(row, score, full) for score in tried]
    if full is not None and math.isinf(errors[0]):
        return None
    if hazards and (math.isinf(max(errors)) or not all(h in row.hazards for h in hazards)):
        return None
    least = number(ask, "min_availability")
    answered = min(0.0 if s.rms_deg is None else (s.availability or 0.0) for s in tried)
    if least is not None and answered < least:
        return None
    latency = number(ask, "max_latency_us")
    if latency is not None and (row.latency_us is None or row.latency_us > latency):
        return None
    limits = [number(ask, "max_error_deg")]
    if wanted(ask, "accuracy") == ["FSS"]:  # a class is a limit where every class asked for has one
        limits.append(0.5)
    largest = min((limit for limit in limits if limit is not None), default=None)
    return None if largest is not None and max(errors) > largest else max(errors)


def partly(row: MeasuredPipeline, ask: Ask) -> tuple[float, float] | None:
    """Error where it answers, and the answered share, of what answers half but too seldom."""
    hazards = wanted(ask, "survive")
    full, least, latency = (
        number(ask, name) for name in ("min_fov_deg", "min_availability", "max_latency_us")
    )
    tried = [row.nominal, *(s for name in hazards for s in row.hazards.get(name, ()))]
    if any(name not in row.hazards for name in hazards):
        return None
    if full is not None and (row.half_fov_deg is None or 2 * row.half_fov_deg < full):
        return None
    if latency is not None and (row.latency_us is None or row.latency_us > latency):
        return None
    errors = [error_over(row, score, full) for score in tried]
    if math.inf not in errors or any(score.rms_deg is None for score in tried):
        return None
    share = min(score.availability or 0.0 for score in tried)
    if share < max(0.5, least or 0.0):
        return None
    known = [
        score.rms_deg or 0.0 if math.isinf(error) else error
        for error, score in zip(errors, tried, strict=True)
    ]
    return max(known), share


def finer(
    pair: Pair, error: float, ask: Ask, table: list[MeasuredPipeline]
) -> list[tuple[object, ...]]:
    """What may be named beside an error: all that err least, if less than a third of it."""
    parts: list[tuple[object, ...]] = []
    least = math.inf
    for (extractor, stages), there in on(pair, table).items():
        if refused(ask, "extractor", {extractor}) or refused(ask, "model", set(stages)):
            continue
        for row in there:
            part = partly(row, ask)
            if part is not None and 3 * part[0] < error and part[0] <= least:
                parts = parts if part[0] == least else []
                least = part[0]
                parts.append((row.dataset, row.extractor, row.model, *part))
    return [] if math.isinf(error) else parts


@dataclass
class Found:
    """A design by brute force: its error (None if only stated) and its studies that meet all."""

    error: float | None
    studies: set[str]
    with_model: set[str]


@dataclass
class Expected:
    """What an answer must hold: studies of each architecture and its designs."""

    studies: dict[Pair, set[str]] = field(default_factory=dict)
    designs: dict[Pair, dict[tuple[str, tuple[str, ...]], Found]] = field(
        default_factory=lambda: defaultdict(dict)
    )


def refused(ask: Ask, level: str, has: set[str]) -> bool:
    """Whether what a design has at a level is not what is asked, or is what is excluded."""
    return any(
        bool(has & kinds(wanted(ask, prefix + level))) == bool(prefix)
        for prefix in ("", "exclude_")
        if prefix + level in ask
    )


def on(pair: Pair, table: list[MeasuredPipeline]) -> Designed:
    found: Designed = defaultdict(list)
    for row in table:
        if (row.detector, row.mask) == pair and row.nominal.rms_deg is not None:
            found[row.extractor_taxonomy, row.stages].append(row)
    return found


def designs_of(there: Iterable[Study], measured: Designed) -> set[tuple[str, tuple[str, ...]]]:
    """Measured designs, and those of studies that no measured one covers."""
    designs = set(measured)
    for study in there:
        for extractor, model in itertools.product(study.of("extractor"), study.of("model")):
            if not any(
                e == extractor and kinds([model]) & set(stages) and stands_for(study, stages)
                for e, stages in measured
            ):
                designs.add((extractor, (model,)))
    return designs


def brute_force(facts: Facts, ask: Ask, table: list[MeasuredPipeline]) -> Expected:
    """Every architecture, every design on it, every study and pipeline, in turn."""
    expected = Expected()
    of_studies = [n for n in ask if n.removeprefix("exclude_") in ("task", "error", "accuracy")]
    included = any(not name.startswith("exclude_") for name in of_studies)
    for pair in itertools.product(VALUES["detector"], VALUES["mask"]):
        there = {k: s for k, s in facts.studies.items() if pair in s.architectures}
        measured = on(pair, table)
        matching = {k for k, s in there.items() if has_what_is_asked(s, ask)}
        if of_studies and not matching and (included or there):
            continue
        if refused(ask, "detector", {pair[0]}) or refused(ask, "mask", {pair[1]}):
            continue
        for extractor, stages in designs_of(there.values(), measured):
            if refused(ask, "extractor", {extractor}) or refused(ask, "model", set(stages)):
                continue
            rows_of = measured.get((extractor, stages), [])
            errors = [e for row in rows_of if (e := error_of(row, ask)) is not None]
            backing = {k for k in matching if rows_of or states(there[k], ask)}
            model = {k for k in backing if stands_for(there[k], stages)}
            taken = {k for k in model if extractor in there[k].of("extractor")}
            if errors if rows_of else taken:
                error = min(errors) if errors else None
                expected.designs[pair][extractor, stages] = Found(error, taken, model)
                expected.studies[pair] = matching
    return expected


def key_of(one: Calibration) -> tuple[str, tuple[str, ...]]:
    return one.extractor, (*one.compensations, one.model)


def measured_pipeline(
    detector: str,
    mask: str,
    error_deg: float,
    *,
    repeatability_deg: float | None = None,
    latency_us: float | None = None,
) -> MeasuredPipeline:
    """A pipeline that errs so much, of a detector and mask."""
    return MeasuredPipeline(
        dataset=f"{detector}-{mask}".lower(),
        detector=detector,
        mask=mask,
        extractor="e",
        extractor_taxonomy="BCTM",
        model="m",
        stages=("SPM",),
        nominal=Score("nominal", error_deg, repeatability_deg=repeatability_deg, availability=1.0),
        half_fov_deg=60.0,
        latency_us=latency_us,
    )
