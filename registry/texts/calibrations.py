"""Calibrations as JSON: their designs, the studies that used them, and their measured pipelines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import numpy as np
from pydantic_core import to_json

from registry.design_arrays import DesignArrays
from registry.designs import Limits
from registry.measured_pipelines import MeasuredPipeline, PartialAnswer, finer_document
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
        self.text = lru_cache(MOST_TEXTS)(self._text)
        self._design = lru_cache(None)(self._design_text)
        self._pipelines = lru_cache(MOST_PIPELINES)(self._pipeline_texts)
        self._finer = lru_cache(MOST_TEXTS)(_finer_text)
        self._support = lru_cache(MOST_TEXTS)(_support_text)

    def prepare(self) -> None:
        """Write the pipelines that answers show over any field, with benches and without."""
        draws = None, (None, CONFIDENCE)
        for half, drawn in product((None, *self.arrays.edges, math.inf), draws):
            best = self.arrays.best_pipelines(Limits(half_field_deg=half, draws=drawn))
            for design in np.flatnonzero(best.row >= 0).tolist():
                self._pipelines(design, int(best.row[design]), best.errors)

    def _text(  # noqa: PLR0917 - by these it is kept
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
        errors : of all pipelines; None for no pipeline
        finer : pipeline on its architecture below the availability limit; -1 for none
        units_within : units of each of its pipelines that keep the limit, nothing without one
        """
        of = self.arrays.designs[design]
        with_model, taken = of.with_model & studies, of.users & studies
        counts = (of_place.bit_count(), with_model.bit_count(), taken.bit_count())
        measured = [b"null"]
        if errors is not None:
            named, finer_text = self._finer(errors, finer)
            measured = []
            for at, error_deg, text in self._pipelines(design, row, errors):
                units = units_within[at] if units_within else NOT_COUNTED
                number = b"null" if units == NOT_COUNTED else b"%d" % units
                said = finer_text if named is not None and named.is_finer(error_deg) else b"null"
                measured.append(b"%b%b}" % (number.join(text), said))
        return b'%b%b],"with_model":%d,"support":%b,"measured":%b,"other_datasets":[%b]' % (
            self._design(design),
            self._studies(taken),
            counts[1],
            self._support(*counts),
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

    def _pipeline_texts(
        self, design: int, row: int, errors: PipelineErrors
    ) -> tuple[tuple[int, float, tuple[bytes, ...]], ...]:
        """Return the texts of a pipeline of a calibration, and of its best on each other data set.

        Of each its number among those of the calibration, its error, and the text up to a finer
        pipeline, in two parts about how many units keep a limit.
        """
        arrays, first = self.arrays, self.arrays.first_row[design]
        others: dict[str, int] = {}
        for at in range(first, arrays.first_row[design + 1]):
            dataset = arrays.rows[at].dataset
            known = others.get(dataset)
            if known is None or errors.error_deg[at] < errors.error_deg[known]:
                others[dataset] = at
        del others[arrays.rows[row].dataset]
        found = []
        for at in (row, *others.values()):
            *begun, ended = self._facts[at]
            judged = to_json_bytes(errors.document(at))[1:-1]
            text = (*begun, b'%b,%b,"finer":' % (ended, judged))
            found.append((at - first, float(errors.error_deg[at]), text))
        return tuple(found)

    @cached_property
    def _facts(self) -> list[list[bytes]]:
        """Of each pipeline its first members, in two parts about how many units keep a limit."""
        texts = [to_json_bytes(row.facts())[:-1] for row in self.arrays.rows]
        counted, between = b'"within_limit":null', b'"within_limit":\0'
        return [text.replace(counted, between).split(b"\0") for text in texts]


def _support_text(*counts: int) -> bytes:
    """Return how the literature backs a calibration (`registry.ranking.support`)."""
    return to_json_bytes(round(support(*counts), 4))


def _finer_text(
    errors: PipelineErrors, finer: int
) -> tuple[PartialAnswer[MeasuredPipeline] | None, bytes]:
    """Return the partial answer of a pipeline and its text; -1 for none."""
    named = None if finer < 0 else errors.partial_answer(finer)
    return named, b"" if named is None else to_json_bytes(finer_document(named))
