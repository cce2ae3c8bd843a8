"""Calibrations as JSON: their designs, the studies that used them, and their measured pipelines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from functools import cached_property, lru_cache
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from pydantic_core import to_json

from registry.design_arrays import DesignArrays
from registry.designs import Limits
from registry.measured_pipelines import finer_document
from registry.pipelines import NOT_COUNTED, PipelineErrors
from registry.ranking import support
from registry.requirements import CONFIDENCE

#: Texts that are kept, some 2 kB each.
MOST_TEXTS = 8192
#: Calibrations over a field whose pipelines' texts are kept, some 1 kB each.
MOST_PIPELINES = 65536


def to_json_bytes(value: Any) -> bytes:
    """Return a value as JSON, what is not finite as null."""
    return to_json(value, inf_nan_mode="null")


class StudyTexts:
    """Sets of studies as JSON.

    Parameters
    ----------
    keys : of the studies, by their bits
    """

    def __init__(self, keys: Sequence[str]) -> None:
        texts = [to_json_bytes(key) for key in keys]
        self._size = len(texts) // 8 + 1
        # All sets of eight studies that follow each other: few texts make any set.
        self._of_bytes = [
            [
                b",".join([text for at, text in enumerate(eight) if bits >> at & 1])
                for bits in range(1 << len(eight))
            ]
            for eight in (texts[start : start + 8] for start in range(0, 8 * self._size, 8))
        ]
        self.text = lru_cache(MOST_TEXTS)(self._text)

    def _text(self, studies: int) -> bytes:
        """Return the keys of studies (bits), with commas between them."""
        packed = studies.to_bytes(self._size, "little")
        return b",".join(
            [texts[bits] for texts, bits in zip(self._of_bytes, packed, strict=True) if bits]
        )


class PipelineText:
    """The measured pipelines of a calibration as JSON: its best, and its best on other data sets.

    Equal pipelines share one object, so that it can be part of a cache key.

    Attributes
    ----------
    text : without counts of units and without finer pipelines
    numbers : of those whose units are known, among all pipelines of the calibration
    errors_deg : of the pipelines
    largest_deg : largest of the errors that are known; -inf without one
    """

    def __init__(
        self, text: bytes, numbers: tuple[int, ...], errors_deg: tuple[float, ...]
    ) -> None:
        self.text = text
        self.numbers = numbers
        self.errors_deg = errors_deg
        self.largest_deg = max(filter(math.isfinite, errors_deg), default=-math.inf)


class CalibrationTexts:
    """Calibrations as JSON, each written once.

    Parameters
    ----------
    arrays : the designs
    studies : writes their studies
    """

    def __init__(self, arrays: DesignArrays, studies: StudyTexts) -> None:
        self.arrays = arrays
        self._studies = studies.text
        self._used = lru_cache(MOST_TEXTS)(self._used_text)
        self._design = lru_cache(None)(self._design_text)
        self._pipelines = lru_cache(MOST_PIPELINES)(self._pipeline_text)
        self._kept: WeakValueDictionary[tuple[bytes, tuple[int, ...]], PipelineText] = (
            WeakValueDictionary()
        )
        self._judged = lru_cache(MOST_TEXTS)(_judged_text)
        self._finer = lru_cache(MOST_TEXTS)(_finer_text)

    def prepare(self) -> None:
        """Write the pipelines that answers show over any field, as many as are kept."""
        draws = None, (None, CONFIDENCE)
        for half, drawn in itertools.product((None, *self.arrays.edges, math.inf), draws):
            best = self.arrays.best_pipelines(Limits(half_field_deg=half, draws=drawn))
            for design in np.flatnonzero(best.row >= 0).tolist():
                if self._pipelines.cache_info().currsize == MOST_PIPELINES:
                    return
                self._pipelines(design, int(best.row[design]), best.errors)

    def parts(  # noqa: PLR0917 - all that a calibration hangs on
        self,
        begun: Iterable[bytes],
        designs: Iterable[int],
        rows: Iterable[int],
        studies: int,
        stated: int,
        errors: PipelineErrors,
        finer: int,
        units_within: bytes,
        ends: tuple[bytes, bytes],
    ) -> list[bytes]:
        """Return calibrations of an architecture, each in four parts.

        Parameters
        ----------
        begun : how each begins, with its rank
        designs, rows : their positions, and those of their best pipelines; -1 for none
        studies : studies of the architecture with what is asked of studies (bits)
        stated : those of them whose stated numbers keep the limits (bits)
        errors : of all pipelines
        finer : pipeline on the architecture below the availability limit; -1 for none
        units_within : of all pipelines how many units keep the limit; nothing without one
        ends : of calibrations that are measured, and of others
        """
        beside = NO_FINER if finer < 0 else self._finer(errors, finer)
        first, of_place = self.arrays.first_row, studies.bit_count()
        parts: list[bytes] = []
        for begins, design, row in zip(begun, designs, rows, strict=True):
            of, counting = self.arrays.designs[design], studies if row >= 0 else stated
            taken, with_model = of.users & counting, (of.with_model & counting).bit_count()
            used = self._used(design, taken, with_model, of_place if taken else 0)
            if row < 0:
                parts += (begins, used, _NOT_MEASURED, ends[1])
                continue
            pipelines = self._pipelines(design, row, errors)
            text, is_coarse = pipelines.text, pipelines.largest_deg > beside[0]
            if units_within or is_coarse:
                units = units_within[first[design] : first[design + 1]]
                text = self._judged(pipelines, units, *(beside if is_coarse else NO_FINER))
            parts += (begins, used, text, ends[0])
        return parts

    def _used_text(self, design: int, taken: int, with_model: int, of_place: int) -> bytes:
        """Return the members of a calibration between its rank and its pipelines.

        Parameters
        ----------
        design : its position
        taken : studies that used it (bits)
        with_model, of_place : how many used its compensations and model, and its architecture; the
            second is 0 where none used it
        """
        backing = round(support(of_place, with_model, taken.bit_count()), 4)
        return b'%b%b],"with_model":%d,"support":%b,"measured":' % (
            *(self._design(design), self._studies(taken)),
            *(with_model, to_json_bytes(backing)),
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

    def _pipeline_text(self, design: int, row: int, errors: PipelineErrors) -> PipelineText:
        """Return the pipeline of a calibration, and its best on each other data set."""
        arrays, first = self.arrays, self.arrays.first_row[design]
        others: dict[str, int] = {}
        for at in range(first, arrays.first_row[design + 1]):
            dataset = arrays.rows[at].dataset
            known = others.get(dataset)
            if known is None or errors.error_deg[at] < errors.error_deg[known]:
                others[dataset] = at
        del others[arrays.rows[row].dataset]
        shown = (row, *others.values())
        texts = [
            b"%b,%b,%b}" % (self._facts[at], to_json_bytes(errors.document(at))[1:-1], _NOT_FINER)
            for at in shown
        ]
        text = b'%b,"other_datasets":[%b]' % (texts[0], b",".join(texts[1:]))
        numbers = tuple([at - first for at in shown if _NOT_COUNTED in self._facts[at]])
        kept = self._kept.get((text, numbers))
        if kept is None:
            errors_deg = tuple(errors.error_deg[list(shown)].tolist())
            kept = self._kept[text, numbers] = PipelineText(text, numbers, errors_deg)
        return kept

    @cached_property
    def _facts(self) -> list[bytes]:
        """Of each pipeline its first members."""
        return [to_json_bytes(row.facts())[:-1] for row in self.arrays.rows]


#: Pipelines of a calibration that has none.
_NOT_MEASURED = b'null,"other_datasets":[]'
#: Members of a pipeline that are replaced where a question asks for units or a finer pipeline.
_NOT_COUNTED, _NOT_FINER = b'"within_limit":null', b'"finer":null'
#: Error above which a pipeline is finer, and its text: for none.
NO_FINER = math.inf, b""


def _judged_text(
    pipelines: PipelineText, units: bytes, coarse_deg: float, finer_text: bytes
) -> bytes:
    """Return the text of pipelines, with how many units of each keep a limit and a finer one.

    Parameters
    ----------
    pipelines : of a calibration
    units : of each pipeline of the calibration; none without a limit
    coarse_deg, finer_text : error above which a pipeline below the availability limit is finer,
        and its text; infinite for none
    """
    text = pipelines.text
    if units:
        counts = [
            _NOT_COUNTED if units[at] == NOT_COUNTED else b'"within_limit":%d' % units[at]
            for at in pipelines.numbers
        ]
        text = _put_in(text, _NOT_COUNTED, counts)
    if pipelines.largest_deg > coarse_deg:
        said = b'"finer":' + finer_text
        coarse = [coarse_deg < error_deg < math.inf for error_deg in pipelines.errors_deg]
        text = _put_in(text, _NOT_FINER, [said if one else _NOT_FINER for one in coarse])
    return text


def _put_in(text: bytes, place: bytes, parts: Sequence[bytes]) -> bytes:
    """Replace every occurrence of `place` in a text, each by the next of as many parts."""
    begun, *others = text.split(place)
    return begun + b"".join(itertools.chain.from_iterable(zip(parts, others, strict=True)))


def _finer_text(errors: PipelineErrors, finer: int) -> tuple[float, bytes]:
    """Return the partial answer of a pipeline, the error above which it is finer, and its text."""
    named = errors.partial_answer(finer)
    if named is None:
        return NO_FINER
    return named.coarse_deg, to_json_bytes(finer_document(named))
