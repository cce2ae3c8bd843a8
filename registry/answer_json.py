"""An answer as JSON: the one form that HTTP, command line, pages and tables take.

An answer has some 180 kB, of which another question changes little. So the text of a calibration,
a path or a node is written once and kept by all that it depends on.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Iterator, Sequence
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from pydantic_core import to_json

from registry.answer import Answer, RankedPlace
from registry.contradiction import against_advice, against_literature, regret_words
from registry.design_arrays import design_arrays
from registry.designs import DesignTable
from registry.judging import OF_STUDIES, Question, advice_for
from registry.path_texts import PathTexts
from registry.paths import path_table
from registry.pipelines import NOT_COUNTED, PipelineErrors
from registry.ranking import TaskMeasure, support
from registry.requirements import CONFIDENCE, Requirements

#: Texts that are kept of each kind, some 16 MB of calibrations and 20 MB of architectures.
MOST_TEXTS, MOST_ARCHITECTURES = 8192, 3072


class _ShownArchitecture(NamedTuple):
    """All that the text of an architecture depends on but its rank and what none beats.

    Attributes
    ----------
    errors : of all pipelines
    judged, advising : what is judged and what advice is asked for (`Question`)
    number : position of the architecture
    studies, stated, measures, rank_of_best : as in `RankedPlace`
    total : how many of its designs meet the requirements
    finer : pipeline that answers too seldom and is named; -1 for none
    usual : the design that most studies used and its pipeline; -1 for none
    best, row : the design with the smallest error and its pipeline; -1 for none
    designs, rows : those that are listed and their pipelines, packed
    units : of all pipelines of all these how many units keep the limit; none without one
    """

    errors: PipelineErrors
    judged: tuple[str, ...]
    advising: tuple[tuple[str, ...] | None, ...]
    number: int
    studies: int
    stated: int
    measures: tuple[TaskMeasure, ...]
    rank_of_best: int
    total: int
    finer: int
    usual: tuple[int, int]
    best: int
    row: int
    designs: bytes
    rows: bytes
    units: tuple[bytes, ...]


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
        paths = path_table(table.facts)
        self._left_out = to_json_bytes([left.to_dict() for left in paths.left_out])
        self._places = table.places
        self._keys = [to_json_bytes(key) for key in table.facts.keys]
        self._studies = lru_cache(MOST_TEXTS)(self._studies_text)
        self._paths = PathTexts(paths, self.arrays, self._studies).text
        self._head = lru_cache(MOST_TEXTS)(self._head_text)
        self._architecture = lru_cache(MOST_ARCHITECTURES)(self._architecture_text)
        self._contradiction = lru_cache(MOST_TEXTS)(self._contradiction_text)
        self._calibration = lru_cache(MOST_TEXTS)(self._calibration_text)
        self._ends = lru_cache(MOST_TEXTS)(_ends_text)
        self._design = lru_cache(None)(self._design_text)
        self._best_rows = lru_cache(MOST_TEXTS)(self._rows_on_datasets)
        self._judged = lru_cache(2 * MOST_TEXTS)(self._judged_text)

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
        unbeaten = answer.pareto
        parts: list[bytes] = []
        for at, shown in enumerate(self._pack_designs(answer, answer.places[:limit], calibrations)):
            begun, ended = self._architecture(shown)
            flag = b"true" if at in unbeaten else b"false"
            parts += (_rank_text(at + 1), *begun, flag, *ended)
        return parts

    def _pack_designs(
        self, answer: Answer, places: Sequence[RankedPlace], calibrations: int | None
    ) -> Iterator[_ShownArchitecture]:
        """Yield what the text of each architecture depends on."""
        question, best, first_row = answer.question, answer.best, self.arrays.first_row
        asked = best.errors, question.judged_requirements, question.advice_key
        finer, usual, limit = (
            question.finest_partial_answers,
            answer.usual,
            question.requirements.largest_deg,
        )
        units = b"" if limit is None else best.errors.units_within(limit).tobytes()
        designs, rows = answer.designs.tobytes(), best.row[answer.designs].tobytes()
        size = answer.designs.itemsize
        for place in places:
            end = place.end if calibrations is None else place.start + calibrations
            listed = slice(size * place.start, size * min(end, place.end))
            counted = () if limit is None else (place.best, *_unpacked(designs[listed]))
            yield _ShownArchitecture(
                *(*asked, place.number, place.studies, place.studies_within_limits, place.measures),
                *(place.rank_of_best, place.end - place.start),
                *(finer.get(place.number, -1), usual.get(place.number, (-1, -1))),
                place.best,
                place.row,
                designs[listed],
                rows[listed],
                tuple([units[first_row[one] : first_row[one + 1]] for one in counted]),
            )

    def _architecture_text(self, of: _ShownArchitecture) -> tuple[list[bytes], list[bytes]]:
        """Return the parts of an architecture before and behind whether none beats it."""
        errors, studies = of.errors, of.studies
        measured, stated = self._ends(of.judged, bool(studies))
        designs, rows = (of.best, *_unpacked(of.designs)), (of.row, *_unpacked(of.rows))
        units, counted = of.units or (b"",) * len(designs), (errors, of.finer)
        best, *listed = (
            (self._calibration(design, row, of.stated, studies), stated)
            if row < 0
            else (self._calibration(design, row, studies, studies, *counted, within), measured)
            for design, row, within in zip(designs, rows, units, strict=True)
        )
        contradiction = b"null"
        if of.usual[0] >= 0:
            first = of.best, of.row, studies if of.row >= 0 else of.stated
            contradiction = self._contradiction(errors, studies, *of.usual, *first)
        head = self._head(of.number, studies, of.advising)
        measures = to_json_bytes([measure.to_dict() for measure in of.measures])
        ended = [
            b',"contradiction":%b,"measures":%b,"count":%d,"calibrations":['
            % (contradiction, measures, of.total)
        ]
        for rank, texts in enumerate(listed, 1):
            ended += (_rank_text(rank), *texts)
        ended.append(b"]}")
        return [b",", head, _rank_text(of.rank_of_best, first=True), *best, b',"pareto":'], ended

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
                measured.append(number.join(self._facts[at]) + self._judged(at, errors, finer))
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

    @cached_property
    def _facts(self) -> list[list[bytes]]:
        """Of each pipeline its first members, in two parts about how many units keep a limit."""
        texts = [to_json_bytes(row.facts())[:-1] for row in self.arrays.rows]
        counted, between = b'"within_limit":null', b'"within_limit":\0'
        return [text.replace(counted, between).split(b"\0") for text in texts]

    def _judged_text(self, row: int, errors: PipelineErrors, finer: int) -> bytes:
        """Return the other members of a pipeline."""
        return b",%b" % to_json_bytes(errors.document(row, finer))[1:]

    def _studies_text(self, studies: int) -> bytes:
        """Return the keys of studies (bits), with commas between them."""
        flags = bin(studies)[:1:-1]
        return b",".join([key for key, flag in zip(self._keys, flags, strict=False) if flag == "1"])


def _unpacked(positions: bytes) -> list[int]:
    found: list[int] = np.frombuffer(positions, np.int64).tolist()
    return found


@lru_cache(None)
def _rank_text(rank: int, *, first: bool = False) -> bytes:
    """Return how a member of a list begins, which ranks begin with 1, or the `first` of one."""
    return b'%b{"rank":%d' % (b"" if first or rank == 1 else b",", rank)


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


_TEXTS: weakref.WeakKeyDictionary[DesignTable, AnswerTexts] = weakref.WeakKeyDictionary()


def answer_json(answer: Answer, limit: int | None = None, calibrations: int | None = None) -> bytes:
    """Return an answer as JSON.

    Parameters
    ----------
    answer : the answer
    limit, calibrations : the most architectures, and calibrations of each; None for all
    """
    return b"".join(_texts(answer.question.table).document(answer, limit, calibrations))


def prepare(table: DesignTable) -> None:
    """Make what answers about a table share, so that no question has to wait for it."""
    texts = _texts(table)
    _ = texts.digest
    for half in (None, *texts.arrays.edges):
        _ = texts.arrays.errors((), half, (None, CONFIDENCE)).unit_errors_deg


def answer_digest(answer: Answer, *shown: object) -> bytes:
    """Return what tells an answer from all others: a digest of the data, and the question.

    That is cheaper than a digest of the answer.

    Parameters
    ----------
    answer : the answer
    shown : what else the JSON depends on
    """
    text = to_json_bytes((answer.sort, *shown))
    digest = _texts(answer.question.table).digest
    return b"%b[%b,%b" % (digest, answer.question.requirements_json, text[1:])


def _texts(table: DesignTable) -> AnswerTexts:
    texts = _TEXTS.get(table)
    if texts is None:
        texts = _TEXTS[table] = AnswerTexts(table)
    return texts
