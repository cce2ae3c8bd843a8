"""An answer as JSON: the one form that HTTP, command line, pages and tables take.

An answer has some 180 kB, of which another question changes little. So the text of a calibration,
a path or a node is written once and kept by all that it depends on.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from pydantic_core import to_json

from registry.answer import Answer, RankedPlace
from registry.contradiction import against_advice, against_literature, regret_words
from registry.design_arrays import design_arrays
from registry.designs import DesignTable
from registry.judging import OF_STUDIES, Question, advice_for
from registry.path_arrays import MOST_SETS, PathTexts, path_arrays
from registry.paths import path_table
from registry.pipelines import NOT_COUNTED, PipelineErrors
from registry.ranking import TaskMeasure, support
from registry.requirements import Requirements

#: Texts that are kept of each kind, some 16 MB of calibrations, and architectures made of these.
MOST_TEXTS, MOST_ARCHITECTURES = 8192, 4096
#: Places for what hangs on the whole answer; JSON has no such byte.
_RANK, _HEAD, _PARETO, _MEASURES = b"\0rank", b"\0head", b"\0pareto", b"\0measures"
_MEASURED, _STATED = b"\0measured", b"\0stated"


def to_json_bytes(value: Any) -> bytes:
    """Return a value as JSON, what is not finite as null."""
    return to_json(value, inf_nan_mode="null")


class AnswerTexts:
    """The texts of answers about one table of designs.

    Parameters
    ----------
    table : of the designs
    """

    def __init__(self, table: DesignTable) -> None:
        self.table = table
        self.arrays = design_arrays(table)
        self.paths = path_arrays(table)
        self._table = path_table(table.facts)
        self._left_out = to_json_bytes([left.to_dict() for left in self._table.left_out])
        self._places = table.places
        self._keys = [to_json_bytes(key) for key in table.facts.keys]
        self._studies = lru_cache(MOST_TEXTS)(self._studies_text)
        self._paths_text = PathTexts(self._table, self._studies).text
        self._head = lru_cache(MOST_TEXTS)(self._head_text)
        self._measures = lru_cache(MOST_TEXTS)(_measures_text)
        self._architecture = lru_cache(MOST_ARCHITECTURES)(self._architecture_pieces)
        self._contradiction = lru_cache(MOST_TEXTS)(self._contradiction_text)
        self._calibration = lru_cache(MOST_TEXTS)(self._calibration_text)
        self._ends = lru_cache(MOST_SETS)(_ends_text)
        self._design = lru_cache(None)(self._design_text)
        self._best_rows = lru_cache(MOST_TEXTS)(self._rows_on_datasets)
        self._pipeline = lru_cache(MOST_TEXTS)(self._pipeline_text)

    @cached_property
    def digest(self) -> bytes:
        """A digest of all that answers are made of."""
        whole = Answer(Question(self.table, Requirements()), "advice")
        made = (answer_json(whole), repr(self.arrays.rows).encode())
        return hashlib.sha256(b"".join(made)).digest()

    def document(self, answer: Answer, limit: int | None, calibrations: int | None) -> list[bytes]:
        """Return an answer in parts: the first architectures, the first calibrations of each."""
        regret, blocked, sets = answer.regret, answer.blocking_constraint, self.paths.sets(answer)
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
            *(b',"paths":[', self._paths_text(sets), b'],"left_out":', self._left_out),
            *(
                b',"blocked":',
                b"null" if blocked is None else to_json_bytes(blocked.to_dict()),
                b"}",
            ),
        ]

    def _architectures(
        self, answer: Answer, limit: int | None, calibrations: int | None
    ) -> list[bytes]:
        question, places = answer.question, answer.places[:limit]
        errors, advising = answer.best.errors, question.advice_key
        ends = [self._ends(question.judged_requirements, studied) for studied in (False, True)]
        parts: list[bytes] = []
        shown = zip(places, *self._pack_designs(answer, places, calibrations), strict=True)
        for rank, (place, packed, units) in enumerate(shown, 1):
            filled = {
                _RANK: b',{"rank":%d,' % rank if rank > 1 else b'{"rank":1,',
                _HEAD: self._head(place.number, place.studies, advising),
                _PARETO: b"true" if rank - 1 in answer.pareto else b"false",
                _MEASURES: self._measures(place.measures),
                **ends[bool(place.studies)],
            }
            pieces = self._architecture(
                errors, place.studies, place.studies_within_limits, packed, units
            )
            parts += [filled.get(piece, piece) for piece in pieces]
        return parts

    def _pack_designs(
        self, answer: Answer, places: Sequence[RankedPlace], calibrations: int | None
    ) -> tuple[list[bytes], list[bytes]]:
        """Return what the text of each architecture depends on beside studies and errors, packed.

        First integers: the number of its designs, the rank of the best of them, the finest
        pipeline that answers too seldom, the design that most studies used and its pipeline; the
        best design and those that are shown, then the pipelines of these; all by position, -1 for
        none. Second of all pipelines of these designs how many units keep the limit on the error;
        nothing where none is asked.
        """
        if not places:
            return [], []
        question, best, designs = answer.question, answer.best, answer.designs
        finer, usual = question.finest_partial_answers, answer.usual
        of_places = [
            (p.start, p.end, p.best_at, finer.get(p.number, -1), usual.get(p.number, -1))
            for p in places
        ]
        start, end, best_at, finest, used = np.array(of_places).T
        count, numbers = end - start, self.arrays.numbers
        at = start[:, None] + numbers[: count.max() if calibrations is None else calibrations]
        # Columns as above: five numbers, then designs, then pipelines.
        width = 1 + at.shape[1]
        packed = np.empty((len(places), 5 + 2 * width), int)
        shown, rows = packed[:, 5 : 5 + width], packed[:, 5 + width :]
        shown[:, 0] = best_at
        shown[:, 1:] = designs.take(at, mode="clip")
        shown[:, 1:][at >= end[:, None]] = -1
        rows[:] = best.row[shown]
        rows[shown < 0] = -1
        place_in = np.empty_like(numbers)
        place_in[designs] = numbers[: len(designs)]
        packed[:, 0] = count
        packed[:, 1] = place_in[best_at] - start + 1
        packed[:, 2] = finest
        packed[:, 3] = used
        packed[:, 4] = best.row[used]
        packed[:, 4][used < 0] = -1
        limit = question.requirements.largest_deg
        if limit is None:
            return [row.tobytes() for row in packed], [b""] * len(places)
        units = np.append(best.errors.units_within(limit), np.uint8(NOT_COUNTED))
        of_rows = units[self.arrays.rows_of[shown]]
        return [row.tobytes() for row in packed], [row.tobytes() for row in of_rows]

    def _architecture_pieces(
        self, errors: PipelineErrors, studies: int, stated: int, packed: bytes, units: bytes
    ) -> list[bytes]:
        """Return an architecture in pieces, with places for what hangs on the whole answer.

        Parameters
        ----------
        errors : of all pipelines
        studies : studies of the architecture with what is asked of studies (bits)
        stated : those of them whose stated numbers keep the limits, too
        packed, units : as `_shown` packs them
        """
        count, rank_of_best, finest, used, used_row, *more = np.frombuffer(packed, int).tolist()
        designs, rows = more[: len(more) // 2], more[len(more) // 2 :]
        size = len(units) // len(designs)
        contradiction = b"null"
        if used >= 0:
            best = designs[0], rows[0], studies if rows[0] >= 0 else stated
            contradiction = self._contradiction(errors, studies, used, used_row, *best)
        pieces = [_RANK, _HEAD]
        for at, (design, row) in enumerate(zip(designs, rows, strict=True)):
            if design < 0:
                break
            if row < 0:
                end, text = _STATED, self._calibration(design, row, stated, studies)
            else:
                within = units[at * size : (at + 1) * size]
                of_row = (errors, finest, within)
                end, text = _MEASURED, self._calibration(design, row, studies, studies, *of_row)
            pieces += (b'%b{"rank":%d' % (b"," if at > 1 else b"", at or rank_of_best), text, end)
            if not at:
                pieces += (
                    *(b',"pareto":', _PARETO, b',"contradiction":', contradiction),
                    *(b',"measures":', _MEASURES, b',"count":%d,"calibrations":[' % count),
                )
        return [*pieces, b"]}"]

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
        return b'%b,"studies":[%b],"best":' % (to_json_bytes(members)[1:-1], self._studies(studies))

    def _contradiction_text(  # noqa: PLR0917 - by these it is kept
        self,
        errors: PipelineErrors,
        studies: int,
        usual: int,
        usual_row: int,
        best: int,
        best_row: int,
        best_studies: int,
    ) -> bytes:
        """Return the sentence where measurement contradicts the literature; null for none.

        It is of the calibration that most studies used and the one with the smallest error.
        """
        arrays = self.arrays
        designs = arrays.designs
        said = against_literature(
            arrays.candidate(usual, usual_row, errors),
            (designs[usual].users & studies).bit_count(),
            arrays.candidate(best, best_row, errors),
            (designs[best].users & best_studies).bit_count(),
        )
        return to_json_bytes(said)

    def _calibration_text(  # noqa: PLR0917 - by these it is kept
        self,
        design: int,
        row: int,
        studies: int,
        of_place: int,
        errors: PipelineErrors | None = None,
        finer: int = -1,
        units_within: bytes = b"",
    ) -> bytes:
        """Return the members of a calibration between its rank and the basis.

        Parameters
        ----------
        design, row : its position, and that of its best pipeline; -1 for none
        studies : studies of its architecture that count (bits)
        of_place : studies of its architecture with what is asked of studies (bits)
        errors, finer : as `PipelineErrors.document` takes them; errors are None for no pipeline
        units_within : units of each of its pipelines that keep the limit, nothing without one
        """
        of = self.arrays.designs[design]
        with_model, taken = of.with_model & studies, of.users & studies
        counts = (of_place.bit_count(), with_model.bit_count(), taken.bit_count())
        measured = [b"null"]
        if errors is not None:
            first = self.arrays.first_row[design]
            measured = []
            for at in self._best_rows(design, row, errors):
                units = units_within[at - first] if units_within else NOT_COUNTED
                number = b"null" if units == NOT_COUNTED else b"%d" % units
                measured.append(number.join(self._pipeline(at, errors, finer)))
        return b'%b%b],"with_model":%d,"support":%b,"measured":%b,"other_datasets":[%b]' % (
            self._design(design),
            self._studies(taken),
            counts[1],
            to_json_bytes(round(support(*counts), 4)),
            measured[0],
            b",".join(measured[1:]),
        )

    def _design_text(self, design: int) -> bytes:
        of = self.arrays.designs[design]
        members = {
            "extractor": of.extractor,
            "compensations": of.stages[:-1],
            "model": of.model,
            "advised": [advice.id for advice in of.advice],
        }
        return b',%b,"studies":[' % to_json_bytes(members)[1:-1]

    def _rows_on_datasets(self, design: int, row: int, errors: PipelineErrors) -> tuple[int, ...]:
        """Return a pipeline of a calibration, and its best on each other data set."""
        arrays = self.arrays
        others: dict[str, int] = {}
        for at in range(arrays.first_row[design], arrays.first_row[design + 1]):
            dataset = arrays.rows[at].dataset
            known = others.get(dataset)
            if known is None or errors.error_deg[at] < errors.error_deg[known]:
                others[dataset] = at
        del others[arrays.rows[row].dataset]
        return row, *others.values()

    def _pipeline_text(self, row: int, errors: PipelineErrors, finer: int) -> list[bytes]:
        """Return a pipeline in two parts, between them the number of units that keep a limit."""
        text = to_json_bytes(errors.document(row, finer))
        return text.replace(b'"within_limit":null', b'"within_limit":\0').split(b"\0")

    def _studies_text(self, studies: int) -> bytes:
        """Return the keys of studies (bits), with commas between them."""
        flags = bin(studies)[:1:-1]
        return b",".join([key for key, flag in zip(self._keys, flags, strict=False) if flag == "1"])


def _ends_text(judged: tuple[str, ...], studied: bool) -> dict[bytes, bytes]:
    """Return the end of a calibration, measured or stated: what each requirement is judged on.

    Parameters
    ----------
    judged : names of the requirements
    studied : whether a study of the architecture has what is asked of studies
    """
    of_studies = "studies" if studied else "advised"
    known = {**dict.fromkeys(OF_STUDIES, of_studies), "properties": "assessed"}
    return {
        kind: b',"basis":%b}'
        % to_json_bytes({name: known.get(name, kind[1:].decode()) for name in judged})
        for kind in (_MEASURED, _STATED)
    }


def _measures_text(measures: tuple[TaskMeasure, ...]) -> bytes:
    return to_json_bytes([measure.to_dict() for measure in measures])


_TEXTS: weakref.WeakKeyDictionary[DesignTable, AnswerTexts] = weakref.WeakKeyDictionary()


def answer_json(answer: Answer, limit: int | None = None, calibrations: int | None = None) -> bytes:
    """Return an answer as JSON.

    Parameters
    ----------
    answer : the answer
    limit, calibrations : the most architectures, and calibrations of each; None for all
    """
    return b"".join(_texts(answer).document(answer, limit, calibrations))


def answer_digest(answer: Answer, *shown: object) -> bytes:
    """Return what tells an answer from all others: a digest of the data, and the question.

    That is cheaper than a digest of the answer.

    Parameters
    ----------
    answer : the answer
    shown : what else the JSON depends on
    """
    text = to_json_bytes((answer.sort, *shown))
    return b"%b[%b,%b" % (_texts(answer).digest, answer.question.requirements_json, text[1:])


def _texts(answer: Answer) -> AnswerTexts:
    table = answer.question.table
    texts = _TEXTS.get(table)
    if texts is None:
        texts = _TEXTS[table] = AnswerTexts(table)
    return texts
