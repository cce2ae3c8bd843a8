"""An answer as JSON: the one form that HTTP, command line, pages and tables take.

An answer has some 180 kB, of which another question changes little. So the text of a calibration,
a path or a node is written once and kept by all that it depends on.
"""

from __future__ import annotations

import hashlib
import math
import weakref
from functools import cached_property, lru_cache

import numpy as np

from registry.answer import Answer
from registry.contradiction import against_advice, against_literature, regret_words
from registry.design_arrays import design_arrays
from registry.designs import DesignTable, Limits
from registry.judging import OF_STUDIES, Question, advice_for
from registry.paths import path_table
from registry.pipelines import PipelineErrors
from registry.ranking import TaskMeasure
from registry.requirements import CONFIDENCE, Requirements
from registry.texts.calibrations import MOST_TEXTS, CalibrationTexts, StudyTexts, to_json_bytes
from registry.texts.paths import PathTexts

#: Architectures whose texts are kept, some 7 kB each.
MOST_ARCHITECTURES = 3072


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
        self._head = lru_cache(MOST_TEXTS)(self._head_text)
        self._architecture = lru_cache(MOST_ARCHITECTURES)(self._architecture_text)
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
        question, best, first_row = answer.question, answer.best, self.arrays.first_row
        errors, judged, advising = best.errors, question.judged_requirements, question.advice_key
        finer, usual, unbeaten = question.finest_partial_answers, answer.usual, answer.pareto
        largest = question.requirements.largest_deg
        within = b"" if largest is None else errors.units_within(largest).tobytes()
        # As bytes, which are quicker to cut and to compare than lists of numbers.
        designs, rows = answer.designs.tobytes(), best.row[answer.designs].tobytes()
        size = answer.designs.itemsize
        units: tuple[bytes, ...] = ()
        parts: list[bytes] = []
        for at, place in enumerate(answer.places[:limit]):
            total = place.end - place.start
            shown = total if calibrations is None else min(calibrations, total)
            listed = slice(size * place.start, size * (place.start + shown))
            if within:
                of_units = place.best, *_unpacked(designs[listed])
                units = tuple([within[first_row[one] : first_row[one + 1]] for one in of_units])
            head, best_text, between, listed_text = self._architecture(
                errors,
                judged,
                advising,
                place.number,
                place.studies,
                place.studies_within_limits,
                place.measures,
                finer.get(place.number, -1),
                usual.get(place.number),
                place.best,
                place.row,
                designs[listed],
                rows[listed],
                units,
            )
            parts += (_rank_text(at + 1), head, _rank_text(place.rank_of_best, first=True))
            parts += (*best_text, b',"pareto":true' if at in unbeaten else b',"pareto":false')
            parts += (between, b"%d" % total, *listed_text)
        return parts

    def _architecture_text(  # noqa: PLR0917 - by these it is kept
        self,
        errors: PipelineErrors,
        judged: tuple[str, ...],
        advising: tuple[tuple[str, ...] | None, ...],
        number: int,
        studies: int,
        stated: int,
        measures: tuple[TaskMeasure, ...],
        finer: int,
        usual: tuple[int, int] | None,
        best: int,
        row_of_best: int,
        designs: bytes,
        rows: bytes,
        units: tuple[bytes, ...],
    ) -> tuple[bytes, tuple[bytes, bytes], bytes, list[bytes]]:
        """Return four parts of an architecture, what changes with every question left out.

        Left out are its rank, behind the first part the rank of its best calibration, behind the
        second whether none beats it, and behind the third how many of its designs meet the
        requirements.

        Parameters
        ----------
        errors : of all pipelines
        judged, advising : what is judged and what advice is asked for (`Question`)
        number : position of the architecture
        studies, stated, measures : as in `RankedPlace`
        finer : most accurate pipeline below the availability limit; -1 for none
        usual : the measured design that most studies used and its pipeline
        best, row_of_best : the design with the smallest error and its pipeline; -1 for none
        designs, rows : those that are listed and their pipelines, packed
        units : of all pipelines of all these how many units keep the limit; none without one
        """
        of_measured, of_stated = self._ends(judged, bool(studies))
        text = self.calibrations.text
        pairs = zip((best, *_unpacked(designs)), (row_of_best, *_unpacked(rows)), strict=True)
        calibrations = []
        for at, (design, row) in enumerate(pairs):
            if row < 0:
                calibrations.append((text(design, row, stated, studies), of_stated))
            else:
                within = units[at] if units else b""
                measured = text(design, row, studies, studies, errors, finer, within)
                calibrations.append((measured, of_measured))
        best_text, *listed = calibrations
        contradiction = b"null"
        if usual is not None:
            first = best, row_of_best, studies if row_of_best >= 0 else stated
            contradiction = self._contradiction(errors, studies, *usual, *first)
        between = b',"contradiction":%b,"measures":%b,"count":' % (
            contradiction,
            to_json_bytes([one.to_dict() for one in measures]),
        )
        texts = [b',"calibrations":[']
        for rank, calibration in enumerate(listed, 1):
            texts += (_rank_text(rank), *calibration)
        texts.append(b"]}")
        return self._head(number, studies, advising), best_text, between, texts

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
    texts.calibrations.prepare()
    arrays = texts.arrays
    for half in (None, *arrays.edges, math.inf):
        _ = arrays.errors((), half, (None, CONFIDENCE)).unit_errors_deg
        arrays.best_pipelines(Limits(half_field_deg=half, draws=(0.0, CONFIDENCE)))
    tasks = table.facts.taxonomy.values("task")
    Answer(Question(table, Requirements({"task": tasks})), "advice")
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
    digest = _texts(answer.question.table).digest
    return b"%b[%b,%b" % (digest, answer.question.requirements_json, text[1:])


def _texts(table: DesignTable) -> AnswerTexts:
    texts = _TEXTS.get(table)
    if texts is None:
        texts = _TEXTS[table] = AnswerTexts(table)
    return texts
