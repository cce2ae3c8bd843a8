"""An answer as JSON: the one form that HTTP, command line, pages and tables take.

An answer has some 180 kB, of which another question changes little. So the text of a calibration,
a path or a node is written once and kept by all that it depends on.
"""

from __future__ import annotations

import hashlib
import itertools
import math
from collections.abc import Sequence
from functools import cached_property, lru_cache

from registry.answer import Answer, RankedPlace
from registry.contradiction import (
    against_advice,
    against_literature,
    is_contradicted,
    regret_words,
)
from registry.design_arrays import design_arrays
from registry.designs import DesignTable, Limits
from registry.judging import OF_STUDIES, Question, advice_for
from registry.paths import path_table
from registry.pipelines import PipelineErrors
from registry.ranking import SORTS, TaskMeasure
from registry.requirements import CONFIDENCE, Requirements
from registry.texts.calibrations import MOST_TEXTS, CalibrationTexts, StudyTexts, to_json_bytes
from registry.texts.paths import PathTexts

#: Architectures whose calibrations are kept, some 7 kB each.
MOST_ARCHITECTURES = 3072
#: An error limit that every pipeline meets; architectures and calibrations of a usual answer.
_LARGEST_DEG, _USUAL_SIZE = 180.0, (20, 5)


class AnswerTexts:
    """The texts of answers about one table of designs.

    Parameters
    ----------
    table : of the designs
    """

    def __init__(self, table: DesignTable) -> None:
        self.table = table
        self.arrays = design_arrays(table)
        paths = path_table(table.facts)
        self._left_out = to_json_bytes([left.to_dict() for left in paths.left_out])
        self._places = table.places
        studies = StudyTexts(table.facts.keys)
        self._studies = studies.text
        self.calibrations = CalibrationTexts(self.arrays, studies)
        self._paths = PathTexts(paths, self.arrays, self._studies).text
        self._kept: dict[tuple[object, ...], tuple[list[bytes], bytes, list[bytes]]] = {}
        self._head = lru_cache(MOST_TEXTS)(self._head_text)
        self._measures = lru_cache(MOST_TEXTS)(_measures_text)
        self._contradiction = lru_cache(MOST_TEXTS)(self._contradiction_text)
        self._ends = lru_cache(MOST_TEXTS)(_ends_text)

    @cached_property
    def digest(self) -> bytes:
        """A digest of all that answers are made of."""
        whole = Answer(Question(self.table, Requirements()), "advice")
        made = (answer_json(whole), repr(self.arrays.rows).encode())
        return hashlib.sha256(b"".join(made)).digest()

    def document(self, answer: Answer, limit: int | None, calibrations: int | None) -> list[bytes]:
        """Return an answer in parts: the first architectures, the first calibrations of each."""
        regret, blocked = answer.regret, answer.blocking_constraint
        untried = {
            hazard: [{"detector": detector, "mask": mask} for detector, mask in pairs]
            for hazard, pairs in answer.untested_architectures.items()
        }
        return [
            *(b'{"requirements":', answer.question.requirements_json),
            b',"sort":"%b","count":%d,"designs":%d,"architectures":['
            % (answer.sort.encode(), len(answer.places), answer.count),
            *self._architectures(answer, limit, calibrations),
            *(
                b'],"contradictions":',
                to_json_bytes(
                    against_advice(answer, answer.question.requirements.include.get("task", ()))
                ),
                b',"regret":',
            ),
            to_json_bytes(None if regret is None else regret.to_dict(regret_words(regret))),
            *(b',"untried":', to_json_bytes(untried), b',"untimed":%d' % answer.untimed_count),
            *(b',"paths":[', self._paths(answer), b'],"left_out":', self._left_out),
            *(
                b',"blocked":',
                b"null" if blocked is None else to_json_bytes(blocked.to_dict()),
                b"}",
            ),
        ]

    def _architectures(
        self, answer: Answer, limit: int | None, calibrations: int | None
    ) -> list[bytes]:
        question, unbeaten = answer.question, answer.pareto
        errors, kept = answer.best.errors, self._kept
        judged, advising = question.judged_requirements, question.advice_key
        finer, usual = question.finest_partial_answers, answer.usual
        # As bytes, which are quicker to cut and to compare than lists of numbers.
        designs, rows = answer.designs.tobytes(), answer.best.row.take(answer.designs).tobytes()
        size = answer.designs.itemsize
        largest = question.requirements.largest_deg
        within = b"" if largest is None else errors.units_within(largest).tobytes()
        positions: list[int] = answer.designs.tolist() if within else []
        parts: list[bytes] = []
        for at, place in enumerate(answer.places[:limit]):
            number, total = place.number, place.end - place.start
            shown = total if calibrations is None else min(calibrations, total)
            end = place.start + shown
            listed = slice(size * place.start, size * end)
            key = (
                *(errors, judged, place.studies, place.stated),
                *(finer.get(number), usual.get(number), place.best, designs[listed], rows[listed]),
                within and self._units([place.best, *positions[place.start : end]], within),
            )
            texts = kept.get(key)
            if texts is None:
                ends = self._ends(judged, place.studies > 0)
                texts = self._calibrations(answer, place, shown, within, ends)
                if len(kept) >= MOST_ARCHITECTURES:
                    kept.clear()
                kept[key] = texts
            best, contradiction, others = texts
            measures = self._measures(place.measures) if place.measures else b"[]"
            parts += (
                *(_rank_text(at + 1), self._head(number, place.studies, advising)),
                *(_rank_text(place.rank_of_best, first=True), *best),
                b',"pareto":%b,"contradiction":%b,"measures":%b,"count":%d,"calibrations":['
                % (b"true" if at in unbeaten else b"false", contradiction, measures, total),
                *others,
            )
        return parts

    def _units(self, designs: Sequence[int], within: bytes) -> bytes:
        """Return how many units keep the limit, of all pipelines of some designs."""
        first = self.arrays.first_row
        return b"".join([within[first[one] : first[one + 1]] for one in designs])

    def _calibrations(
        self,
        answer: Answer,
        place: RankedPlace,
        shown: int,
        within: bytes,
        ends: tuple[bytes, bytes],
    ) -> tuple[list[bytes], bytes, list[bytes]]:
        """Return the best calibration of an architecture, what it contradicts, and those shown.

        The rank of the best is left out.
        """
        number, studies, errors = place.number, place.studies, answer.best.errors
        listed = answer.designs[place.start : place.start + shown]
        texts = self.calibrations.parts(
            (b"", *_rank_texts(shown)),
            (place.best, *listed.tolist()),
            (place.row, *answer.best.row[listed].tolist()),
            *(studies, place.stated, errors),
            *(answer.question.finest_partial_answers.get(number, -1), within, ends),
        )
        texts.append(b"]}")
        contradiction = b"null"
        if number in answer.usual:
            design, row, error_deg = answer.usual[number]
            if is_contradicted(error_deg, place.error_deg):
                designs, compared = self.arrays.designs, (design, row, place.best, place.row)
                counts = [(designs[one].users & studies).bit_count() for one in compared[::2]]
                contradiction = self._contradiction(errors, *counts, *compared)
        return texts[1:4], contradiction, texts[4:]

    def _head_text(
        self, number: int, studies: int, advising: tuple[tuple[str, ...] | None, ...]
    ) -> bytes:
        """Return the members of an architecture before its best calibration."""
        place = self._places[number]
        detector, mask = place.architecture
        advice, _ = advice_for(place, advising)
        advised = [one.value for one in place.advice if one.requirement == "task"]
        counts = {
            task: (bits & studies).bit_count()
            for task, bits in {**dict.fromkeys(advised, 0), **place.tasks}.items()
        }
        members = {
            "detector": detector,
            "mask": mask,
            "tasks": [
                {"task": task, "studies": count, "advised": task in advised}
                for task, count in counts.items()
                if count or task in advised
            ],
            "advised": bool(advice),
            "advice": [one.to_dict() for one in advice],
        }
        return b',%b,"studies":[%b],"best":' % (
            to_json_bytes(members)[1:-1],
            self._studies(studies),
        )

    def _contradiction_text(  # noqa: PLR0917 - by these it is kept
        self,
        errors: PipelineErrors,
        used: int,
        tried: int,
        usual: int,
        usual_row: int,
        best: int,
        best_row: int,
    ) -> bytes:
        """Return the sentence where measurement contradicts the literature; null for none.

        It is of the calibration that most studies used and the one with the smallest error, both
        measured: how many studies used each, and the positions of both and of their pipelines.
        """
        pairs = (usual, usual_row), (best, best_row)
        first, second = (self.arrays.candidate(*pair, errors) for pair in pairs)
        return to_json_bytes(against_literature(first, used, second, tried))


def _measures_text(measures: tuple[TaskMeasure, ...]) -> bytes:
    return to_json_bytes([one.to_dict() for one in measures])


@lru_cache(None)
def _rank_text(rank: int, *, first: bool = False) -> bytes:
    """Return how a member of a list begins, which ranks begin with 1, or the `first` of one."""
    return b'%b{"rank":%d' % (b"" if first or rank == 1 else b",", rank)


@lru_cache(None)
def _rank_texts(count: int) -> list[bytes]:
    return [_rank_text(rank) for rank in range(1, count + 1)]


def _ends_text(judged: tuple[str, ...], studied: bool) -> tuple[bytes, bytes]:
    """Return the end of a calibration, measured or stated: what each requirement is judged on.

    Parameters
    ----------
    judged : names of the requirements
    studied : whether a study of the architecture has what is asked of studies
    """
    of_studies = "studies" if studied else "advised"
    known = {**dict.fromkeys(OF_STUDIES, of_studies), "properties": "assessed"}
    measured, stated = (
        b',"basis":%b}' % to_json_bytes({name: known.get(name, kind) for name in judged})
        for kind in ("measured", "stated")
    )
    return measured, stated


def answer_json(answer: Answer, limit: int | None = None, calibrations: int | None = None) -> bytes:
    """Return an answer as JSON.

    Parameters
    ----------
    answer : the answer
    limit, calibrations : the most architectures, and calibrations of each; None for all
    """
    texts = answer.question.table.made(AnswerTexts)
    return b"".join(texts.document(answer, limit, calibrations))


def prepare(table: DesignTable) -> None:
    """Make what answers about a table share, so that no question has to wait for it."""
    texts = table.made(AnswerTexts)
    texts.calibrations.prepare()
    arrays = texts.arrays
    for half in (None, *arrays.edges, math.inf):
        _ = arrays.errors((), half, (None, CONFIDENCE)).ranked_unit_errors
        arrays.best_pipelines(Limits(half_field_deg=half, draws=(0.0, CONFIDENCE)))
    fields = [None, *(2 * half for half in arrays.edges)]
    tasks = table.facts.taxonomy.values("task")
    for asked in (
        *(Requirements(min_fov_deg=field) for field in fields),
        *(Requirements({"task": (task,)}) for task in tasks),
        Requirements({"task": tasks}),
    ):
        for limit, sort in itertools.product((None, _LARGEST_DEG), SORTS):
            limited = asked.with_value("max_error_deg", limit)
            answer_json(Answer(Question(table, limited), sort), *_USUAL_SIZE)
    _ = texts.digest, arrays.cone_edges


def answer_digest(answer: Answer, *shown: object) -> bytes:
    """Return what tells an answer from all others: a digest of the data, and the question.

    That is cheaper than a digest of the answer.

    Parameters
    ----------
    answer : the answer
    shown : what else the JSON depends on
    """
    text = to_json_bytes((answer.sort, *shown))
    digest = answer.question.table.made(AnswerTexts).digest
    return b"%b[%b,%b" % (digest, answer.question.requirements_json, text[1:])
