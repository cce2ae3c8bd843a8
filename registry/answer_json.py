"""An answer as JSON: the one form that HTTP, command line, pages and tables take.

An answer has some 180 kB, of which another question changes little. So the text of a calibration,
a path or a node is written once and kept by all that it depends on.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Mapping
from functools import cached_property, lru_cache
from typing import Any

from pydantic_core import to_json

from registry.answer import Answer, RankedPlace
from registry.contradiction import against_advice, against_literature, regret_words
from registry.design_arrays import design_arrays
from registry.designs import DesignTable
from registry.judging import Question, advice_for
from registry.path_arrays import MOST_SETS, StudySets, path_arrays, unpack
from registry.paths import PATH_LEVELS, path_table
from registry.pipelines import PipelineErrors
from registry.ranking import TaskMeasure, support
from registry.requirements import Requirements

#: Texts that are kept of each kind: some 16 MB of calibrations, which are the longest.
MOST_TEXTS = 8192


def encoded(value: Any) -> bytes:
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
        self._left_out = encoded([left.to_dict() for left in self._table.left_out])
        self._places = table.places
        self._studies = lru_cache(MOST_TEXTS)(self._studies_text)
        self._behind = lru_cache(MOST_SETS)(self._behind_text)
        self._path = lru_cache(MOST_TEXTS)(self._path_text)
        self._node = lru_cache(MOST_TEXTS)(self._node_text)
        self._link = lru_cache(MOST_TEXTS)(self._link_text)
        self._head = lru_cache(MOST_TEXTS)(self._head_text)
        self._measures = lru_cache(MOST_TEXTS)(_measures_text)
        self._contradiction = lru_cache(MOST_TEXTS)(self._contradiction_text)
        self._calibration = lru_cache(MOST_TEXTS)(self._calibration_text)
        self._design = lru_cache(None)(self._design_text)
        self._measured = lru_cache(MOST_TEXTS)(self._measured_text)
        self._pipeline = lru_cache(MOST_TEXTS)(self._pipeline_text)

    @cached_property
    def digest(self) -> bytes:
        """A digest of all that answers are made of."""
        whole = Answer(Question(self.table, Requirements()), "advice")
        made = (answer_json(whole), repr(self.arrays.rows).encode())
        return hashlib.sha256(b"".join(made)).digest()

    def document(self, answer: Answer, limit: int | None, calibrations: int | None) -> list[bytes]:
        """Return an answer in parts: the first architectures, the first calibrations of each."""
        regret, blocked, sets = answer.regret, answer.blocked, self.paths.sets(answer)
        untried = {
            hazard: [{"detector": detector, "mask": mask} for detector, mask in pairs]
            for hazard, pairs in answer.untried.items()
        }
        return [
            *(b'{"requirements":', encoded(answer.question.asked.to_dict())),
            b',"sort":"%b","count":%d,"designs":%d,"architectures":['
            % (answer.sort.encode(), len(answer.places), answer.count),
            *self._architectures(answer, limit, calibrations),
            *(
                b'],"contradictions":',
                encoded(against_advice(answer, answer.question.asked.include.get("task", ()))),
                b',"regret":',
            ),
            encoded(None if regret is None else regret.to_dict(regret_words(regret))),
            *(b',"untried":', encoded(untried), b',"untimed":%d' % answer.untimed),
            *(b',"paths":[', self._behind(sets), b'],"left_out":', self._left_out),
            *(b',"blocked":', encoded(None if blocked is None else blocked.to_dict()), b"}"),
        ]

    def _architectures(
        self, answer: Answer, limit: int | None, calibrations: int | None
    ) -> list[bytes]:
        question, best, first_row = answer.question, answer.best, self.arrays.first_row
        errors, finer, advising = best.errors, question.finer, question.advice_key
        units = errors.units_within(question.asked.largest_deg).tobytes()
        rows: list[int] = best.row.tolist()
        ends = {
            (measured, studied): b',"basis":%b}'
            % encoded(question.basis(measured=measured, studied=studied))
            for measured in (True, False)
            for studied in (True, False)
        }
        parts: list[bytes] = []
        calibration = self._calibration
        for rank, place in enumerate(answer.places[:limit], 1):
            studies, stated, start = place.studies, place.stated, place.start
            last = place.end if calibrations is None else min(place.end, start + calibrations)
            finest = finer.get(place.number, -1)
            end = {measured: ends[measured, bool(studies)] for measured in (True, False)}
            shown: list[int] = answer.designs[start:last].tolist()
            of_shown: list[bytes] = []
            for at, design in enumerate((place.best_at, *shown)):
                row = rows[design]
                if row < 0:
                    text = calibration(design, row, stated, studies, None, -1, b"")
                else:
                    within = units[first_row[design] : first_row[design + 1]]
                    text = calibration(design, row, studies, studies, errors, finest, within)
                of_shown += (
                    b',{"rank":%d' % (at or answer.rank_of_best(place)),
                    text,
                    end[row >= 0],
                )
            of_shown[0], of_shown[3] = of_shown[0][1:], of_shown[3][1:]
            parts += (
                b'%b{"rank":%d,' % (b"," if rank > 1 else b"", rank),
                self._head(place.number, studies, advising),
                *of_shown[:3],
                b',"pareto":true' if rank - 1 in answer.pareto else b',"pareto":false',
                *(b',"contradiction":', self._against(answer, place)),
                *(b',"measures":', self._measures(place.measures)),
                b',"count":%d,"calibrations":[' % (place.end - start),
                *of_shown[3:],
                b"]}",
            )
        return parts

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
        return b'%b,"studies":[%b],"best":' % (encoded(members)[1:-1], self._studies(studies))

    def _against(self, answer: Answer, place: RankedPlace) -> bytes:
        """Return the sentence where measurement contradicts the literature; null for none."""
        usual = answer.usual.get(place.number)
        if usual is None:
            return b"null"
        rows, best = answer.best.row, place.best_at
        return self._contradiction(
            *(answer.best.errors, place.studies, usual, int(rows[usual]), best, int(rows[best])),
            place.studies if rows[best] >= 0 else place.stated,
        )

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
        arrays = self.arrays
        designs = arrays.designs
        said = against_literature(
            arrays.candidate(usual, usual_row, errors),
            (designs[usual].taken & studies).bit_count(),
            arrays.candidate(best, best_row, errors),
            (designs[best].taken & best_studies).bit_count(),
        )
        return encoded(said)

    def _calibration_text(  # noqa: PLR0917 - by these it is kept
        self,
        design: int,
        row: int,
        studies: int,
        of_place: int,
        errors: PipelineErrors | None,
        finer: int,
        units_within: bytes,
    ) -> bytes:
        """Return the members of a calibration between its rank and the basis.

        Parameters
        ----------
        design, row : its position, and that of its best pipeline; -1 for none
        studies : studies of its architecture that count (bits)
        of_place : studies of its architecture with what is asked of studies (bits)
        errors, finer, units_within : as `PipelineErrors.document` takes them, of all its
            pipelines; errors are None for none
        """
        of = self.arrays.designs[design]
        with_model, taken = of.with_model & studies, of.taken & studies
        counts = (of_place.bit_count(), with_model.bit_count(), taken.bit_count())
        return b'%b%b],"with_model":%d,"support":%b,"measured":%b' % (
            self._design(design),
            self._studies(taken),
            counts[1],
            encoded(round(support(*counts), 4)),
            self._measured(design, row, errors, finer, units_within),
        )

    def _design_text(self, design: int) -> bytes:
        of = self.arrays.designs[design]
        members = {
            "extractor": of.extractor,
            "compensations": of.stages[:-1],
            "model": of.model,
            "advised": [advice.id for advice in of.advice],
        }
        return b',%b,"studies":[' % encoded(members)[1:-1]

    def _measured_text(
        self, design: int, row: int, errors: PipelineErrors | None, finer: int, units_within: bytes
    ) -> bytes:
        """Return the best pipeline of a calibration, and its best on each other data set."""
        if errors is None:
            return b'null,"other_datasets":[]'
        arrays, first = self.arrays, self.arrays.first_row[design]
        others: dict[str, int] = {}
        for at in range(first, arrays.first_row[design + 1]):
            dataset = arrays.rows[at].dataset
            known = others.get(dataset)
            if known is None or errors.error_deg[at] < errors.error_deg[known]:
                others[dataset] = at
        del others[arrays.rows[row].dataset]
        texts = [
            self._pipeline(at, errors, finer, units_within[at - first])
            for at in (row, *others.values())
        ]
        return b'%b,"other_datasets":[%b]' % (texts[0], b",".join(texts[1:]))

    def _pipeline_text(
        self, row: int, errors: PipelineErrors, finer: int, units_within: int
    ) -> bytes:
        return encoded(errors.document(row, units_within, finer))

    def _studies_text(self, studies: int) -> bytes:
        """Return the keys of studies (bits), with commas between them."""
        return encoded(self._table.studies(studies))[1:-1]

    def _behind_text(self, sets: StudySets) -> bytes:
        """Return paths, nodes and links."""
        texts = (
            b",".join(map(text, packed))
            for text, packed in zip((self._path, self._node, self._link), sets, strict=True)
        )
        return b'%b],"nodes":[%b],"links":[%b' % tuple(texts)

    def _path_text(self, packed: bytes) -> bytes:
        at, studies = unpack(packed)
        return self._with_studies(
            dict(zip(PATH_LEVELS, self._table.paths[at], strict=True)), studies
        )

    def _node_text(self, packed: bytes) -> bytes:
        at, studies = unpack(packed)
        level, value, name = self._table.nodes[at]
        about = {"id": f"{level}:{value}", "level": level, "value": value, "name": name}
        return self._with_studies({**about, "count": studies.bit_count()}, studies)

    def _link_text(self, packed: bytes) -> bytes:
        at, studies = unpack(packed)
        source, target = self._table.links[at]
        about = {"source": source, "target": target, "value": studies.bit_count()}
        return self._with_studies(about, studies)

    def _with_studies(self, members: Mapping[str, object], studies: int) -> bytes:
        return b'%b,"studies":[%b]}' % (encoded(members)[:-1], self._studies(studies))


def _measures_text(measures: tuple[TaskMeasure, ...]) -> bytes:
    return encoded([measure.to_dict() for measure in measures])


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
    asked = encoded((answer.question.asked.to_dict(), answer.sort, *shown))
    return _texts(answer).digest + asked


def _texts(answer: Answer) -> AnswerTexts:
    table = answer.question.table
    texts = _TEXTS.get(table)
    if texts is None:
        texts = _TEXTS[table] = AnswerTexts(table)
    return texts
