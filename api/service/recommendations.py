"""Recommendations: requirements to the document that HTTP, pages and command line give."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import Any
from urllib.parse import quote, urlencode

from api.schema.boards import HeightOrder
from api.schema.flows import LeftOut, Link, Node
from api.schema.parameters import DEFAULT_PAGE
from api.schema.recommendations import (
    Advised,
    AnswerFlow,
    Architecture,
    Blocked,
    Calibration,
    Card,
    Contradiction,
    Designs,
    EvidenceState,
    Measured,
    Path,
    RecommendationRow,
    Recommendations,
    Relaxation,
    Reported,
    TaskMeasure,
)
from api.schema.requirements import Requirements, RequirementsBody, RequirementsQuery
from api.schema.table import columns_of
from api.service.documents import Document, list_document
from api.service.knowledge import Knowledge
from api.service.pagination import Page, page
from api.service.problems import Problem, Violation
from api.service.reasons import notes, reason
from registry import calibration as found_by
from registry import recommendation
from registry.answer import Answer, RankedArchitecture
from registry.comparison import calibration_name, contradictions
from registry.height_order import HeightOrder as FoundOrder
from registry.measured_pipelines import Measurements
from registry.paths import PATH_LEVELS, answer_flow
from registry.relaxation import Explanation
from registry.reports import Report
from registry.requirements import PARAMETERS, SETTINGS
from registry.studies import Facts
from registry.taxonomy import InvalidValueError
from survey_data import labels

MOST_REPORTS = 3
"""Reports named for an architecture; `links` leads to all."""

PATH = "/v1/recommendations"


def ask(asked: Requirements, measured: Measurements, facts: Facts) -> Answer:
    """Return the answer to requirements that were read from a query, a body or a command line.

    Raises
    ------
    Problem
        For a value that the schema lacks, such as an unknown processor.
    """
    names = [n for n in (*PARAMETERS, *SETTINGS, "mission") if n in asked.model_fields_set]
    given = {name: getattr(asked, name) for name in names}
    try:
        return recommendation.recommend(given, measured, sort=asked.sort, facts=facts)
    except InvalidValueError as error:
        wrong = Violation(error.parameter, str(error.value), error.expected, error.nearest)
        raise Problem(422, "invalid-value", errors=[wrong]) from error


def recommendations(known: Knowledge, query: RequirementsQuery) -> Document:
    """Rank architectures (detector + mask) whose reported or measured evidence meets requirements.

    Each with its best calibration (extractor + compensations + model). Values of one attribute are
    alternatives; all other requirements must hold. An empty answer names the requirement that
    excludes all, and changes that would help. CSV: a row per calibration, all of them.
    """
    return _answered(known, query)


def recommend(known: Knowledge, body: RequirementsBody) -> Document:
    """As GET, with the requirements as JSON. A list of one value may be given as that value."""
    return _answered(known, body)


def _answered(known: Knowledge, asked: Requirements) -> Document:
    answer = _ask(known, asked)
    shown = page(answer.architectures, PATH, asked)
    return Document(
        document(answer, asked, shown.items, shown.next).model_dump(),
        columns_of(RecommendationRow),
        lambda: [row.model_dump() for row in rows(answer)],
    )


def recommendations_flow(known: Knowledge, query: RequirementsQuery) -> Document:
    """Studies behind an answer, as paths, nodes and links from task to extractor."""
    found = flow(_ask(known, query)).model_dump()
    return Document(found, columns_of(Path), lambda: found["paths"])


def recommended_designs(known: Knowledge, query: RequirementsQuery) -> Document:
    """Every calibration that meets the requirements, as flat rows, paged."""
    shown = _design_page(_ask(known, query), query)
    items = [row.model_dump() for row in shown.items]
    return list_document(shown, items, RecommendationRow, query=query)


def _ask(known: Knowledge, query: Requirements) -> Answer:
    return ask(query, known.measured_pipelines, known.of(query.edition).facts)


def document(
    answer: Answer, asked: Requirements, shown: Sequence[RankedArchitecture], next_page: str | None
) -> Recommendations:
    """Return an answer as its document.

    Parameters
    ----------
    asked : how much of it is wanted
    shown : the architectures of this page
    next_page : cursor of the next one
    """
    most = asked.calibrations if "calibrations" in asked.include else 0
    chosen = {name: getattr(asked, name) for name in ("edition", "sort")}
    changed = {n: one for n, one in chosen.items() if one != type(asked).model_fields[n].default}
    asking = urlencode({**answer.question.requirements.to_dict(), **changed}, doseq=True)
    links = {
        "csv": f"{PATH}?{asking}&format=csv" if asking else f"{PATH}?format=csv",
        "flow": f"{PATH}/flow?{asking}" if asking else f"{PATH}/flow",
    }
    return Recommendations(
        requirements=answer.question.requirements.to_dict(),
        level=answer.level,
        sort=answer.sort,
        order=answer.order,
        count=len(answer.architectures),
        designs=answer.design_count,
        notes=list(notes(answer)),
        height_order=None if (found := answer.height_order) is None else _order(found),
        cards=[] if answer.is_asked else list(_cards(answer)),
        architectures=[architecture(answer, one, most) for one in shown],
        next=next_page,
        contradictions=[
            Contradiction(
                **{**vars(one), "first_own_error_deg": _digits(one.first_own_error_deg, 5)}
                | {"other_own_error_deg": _digits(one.other_own_error_deg, 5)},
                ratio=_digits(one.ratio, 3),
                sentence=one.sentence,
            )
            for one in (contradictions(answer) if answer.is_asked else ())
        ],
        blocked=None if answer.explanation is None else _blocked(answer.explanation),
        paths=flow(answer).paths if "paths" in asked.include else None,
        rows=_designs(answer, asked) if "designs" in asked.include else None,
        links=links,
    )


def architecture(answer: Answer, one: RankedArchitecture, most: int = 0) -> Architecture:
    """Return an architecture of an answer with its first calibrations."""
    place = one.place
    detector, mask = place.architecture
    listed = islice(answer.calibrations(one), most) if most else None
    both = urlencode({"detector": detector, "mask": mask})
    links = {"page": f"/architectures/{quote(detector)}/{quote(mask)}"}
    if place.studies:
        links["studies"] = f"/v1/studies?{both}"
    if one.best is not None and one.best.pipeline is not None:
        links["board"] = f"/datasets/{one.best.pipeline.dataset}"
    return Architecture(
        rank=one.rank,
        tied=one.tied,
        detector=detector,
        mask=mask,
        built=place.is_built,
        meets=list(one.meets),  # type: ignore[arg-type]  # of the two words
        reason=reason(answer, one),
        evidence=[
            EvidenceState(requirement=name, reported=r, measured=m, advised=a)  # type: ignore[arg-type]
            for name, (r, m, a) in one.evidence.items()
        ],
        studies=len(place.studies),
        products=len(place.products),
        reports=[_reported(report) for report in one.reports[:MOST_REPORTS]],
        advised=list(_advised(answer, one)),
        best=None if one.best is None else _calibration(answer, one.best),
        measures=[TaskMeasure(**vars(measure)) for measure in one.measures],
        count=one.calibrations,
        calibrations=None if listed is None else [_calibration(answer, c) for c in listed],
        links=links,
    )


def rows(answer: Answer) -> Iterator[RecommendationRow]:
    """Yield all calibrations of an answer as rows of a table."""
    for one in answer.architectures:
        detector, mask = one.place.architecture
        reporting = one.reports if "reported" in one.meets else ()
        figures = [report.rms_deg for report in reporting if report.rms_deg is not None]
        found: list[found_by.Calibration | None] = [*answer.calibrations(one)]
        for rank, calibration in enumerate(found or [None], start=1):
            made = None if calibration is None else _calibration(answer, calibration)
            yield RecommendationRow(
                rank=one.rank,
                detector=detector,
                mask=mask,
                built=one.place.is_built,
                meets=list(one.meets),
                reported_by=[report.key for report in reporting],
                reported_rms_deg=_digits(min(figures, default=None)),
                calibration=None if made is None else rank,
                name=None if made is None else made.name,
                extractor=None if made is None else made.extractor,
                compensations=[] if made is None else made.compensations,
                model=None if made is None else made.model,
                advised=None if made is None else made.advised,
                calibration_studies=[] if made is None else made.studies,
                measured=None if made is None else made.measured,
            )


def flow(answer: Answer) -> AnswerFlow:
    """Return the decision flow behind an answer."""
    made = answer_flow(answer)
    return AnswerFlow(
        levels=list(made.levels),
        paths=[
            Path(**dict(zip(PATH_LEVELS, path, strict=True)), studies=list(studies))
            for path, studies in made.paths.items()
        ],
        nodes=[Node(**node.to_dict()) for node in made.nodes],
        links=[Link(**link.to_dict()) for link in made.links],
        left_out=[LeftOut(**left.to_dict()) for left in made.left_out],  # type: ignore[arg-type]
    )


def _designs(answer: Answer, asked: Requirements) -> Designs:
    """Return the first page of all calibrations, with the address of the next."""
    whole = asked.model_copy(update={"limit": DEFAULT_PAGE, "cursor": None, "include": []})
    shown = _design_page(answer, whole)
    address = None if shown.link is None else shown.link[1 : shown.link.index(">")]
    return Designs(items=list(shown.items), total=shown.total, next=address)


def _design_page(answer: Answer, asked: Requirements) -> Page[RecommendationRow]:
    """Return a page of all calibrations of an answer."""
    return page(list(rows(answer)), f"{PATH}/designs", asked)


def _cards(answer: Answer) -> Iterator[Card]:
    """Yield three ways to begin where nothing is asked."""
    every = answer.architectures
    measured = [one for one in every if "measured" in one.meets]
    if every:
        most = max(every, key=lambda one: len(one.place.studies))
        yield _card("most built", most, f"used in {len(most.place.studies)} studies")
    advised = [
        one
        for one in measured
        if any((a.requirement, a.value) == ("task", "Accuracy") for a in one.place.advice)
    ]
    for title, among in (("advised for accuracy", advised), ("lowest simulated", measured)):
        if among:
            best = min(among, key=lambda one: one.shown_deg)
            built = "" if best.place.is_built else "; built by nobody we know of"
            kind = "error in flight" if answer.level == "flight" else "own error"
            yield _card(title, best, f"{kind} {best.shown_deg:.3g} deg, simulated{built}")


def _card(title: Any, one: RankedArchitecture, words: str) -> Card:
    detector, mask = one.place.architecture
    return Card(title=title, detector=detector, mask=mask, built=one.place.is_built, words=words)


def _order(found: FoundOrder) -> HeightOrder:
    return HeightOrder(**vars(found), sentence=found.sentence)


def _reported(report: Report) -> Reported:
    study = report.study
    return Reported(
        key=report.key,
        kind=report.kind,
        name=report.name,
        year=None if study is None else study.year,
        doi="" if study is None else study.doi,
        accuracy_deg=None if report.accuracy is None else report.accuracy.value_deg,
        accuracy_kind=None if report.accuracy is None else report.accuracy.label,
        rms_deg=_digits(report.rms_deg),
        classes=list(report.classes),
        fov_deg=report.fov_deg,
        mass_g=report.mass_g,
        power_mw=report.power_mw,
        supply=report.supply,
        rate_hz=report.rate_hz,
    )


def _advised(answer: Answer, one: RankedArchitecture) -> Iterator[Advised]:
    """Yield what the survey advises an architecture for, of what is asked; all where nothing is."""
    include = answer.question.requirements.include
    asked = {name: include[name] for name in ("task", "accuracy", "error") if name in include}
    found: dict[tuple[str, str], list[str]] = {}
    for advice in one.place.advice:
        wanted = asked.get(advice.requirement, ())
        if advice.value in wanted or (not asked and advice.requirement != "error"):
            how = " with ".join(filter(None, (advice.model_category, advice.extractor)))
            section = labels.name(advice.section)
            found.setdefault((advice.value, section), []).append(how)
    for (value, section), ways in found.items():
        yield Advised(value=value, how=" or ".join(filter(None, ways)), section_name=section)


def _calibration(answer: Answer, one: found_by.Calibration) -> Calibration:
    design, pipeline = one.design, one.pipeline
    *compensations, model = design.stages
    measured = None if pipeline is None else (pipeline.extractor, pipeline.model)
    return Calibration(
        name=calibration_name(design.extractor, design.stages, measured),
        extractor=design.extractor,
        compensations=compensations,
        model=model,
        advised=bool(design.advice),
        studies=sorted(design.users),
        with_model=len(design.with_model),
        measured=_measured(answer, one),
    )


def _measured(answer: Answer, one: found_by.Calibration) -> Measured | None:
    pipeline, own, judged = one.pipeline, one.own, one.judged
    if pipeline is None or own is None or judged is None:
        return None
    asked = answer.question.requirements
    low, high = one.own_interval_deg or (None, None)
    least, most = one.flight_interval_deg or (None, None)
    whole = pipeline.half_fov_deg is None or own.field_deg == 2 * pipeline.half_fov_deg
    on_the_ground = pipeline.own or pipeline
    bounds = {score.condition: score.bound_deg for score in on_the_ground.scores(asked.hazards)}
    return Measured(
        dataset=pipeline.dataset,
        extractor=pipeline.extractor,
        model=pipeline.model,
        condition=judged.condition,
        field_deg=judged.field_deg,
        flight_error_deg=None
        if least is None or not one.flight
        else _digits(one.flight.error_deg, 5),
        flight_low_deg=_digits(least),
        flight_high_deg=_digits(most),
        own_error_deg=None if low is None else _digits(own.error_deg, 5),
        own_low_deg=_digits(low),
        own_high_deg=_digits(high),
        on_bench_deg=None if asked.bench_deg is None else _digits(one.judged_deg),
        needs_bench_deg=one.needs_bench_deg,
        units_within=one.units_within,
        bound_deg=_digits(bounds.get(own.condition)) if whole else None,
        availability=_digits(one.availability),
        latency_us=_digits(one.latency_us, 3),
        needs=list(pipeline.needs),
    )


def _blocked(explanation: Explanation) -> Blocked:
    return Blocked(
        constraint=" + ".join(explanation.constraints),
        detail=explanation.detail,
        relaxations=[
            Relaxation(
                drop=_plain(one.drop),
                change=_plain(one.change),
                architectures=one.architectures,
                words=one.words,
            )
            for one in explanation.relaxations
        ],
    )


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    return {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}


def _digits(number: float | None, digits: int = 4) -> float | None:
    """Return a number rounded to the digits that it deserves."""
    return None if number is None else float(f"{number:.{digits}g}")
