"""Errors of samples as a journal has them: JSON objects with numbers in base 64."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark.contract import Cell
from benchmark.results.samples import CellErrors, Directions, SampleErrors

_CELL = frozenset({"cell", "error_deg", "doubt"})
_DIRECTIONS = frozenset({"directions", "sun", "observable", "bound_deg"})


def sample_records(measured: SampleErrors) -> list[dict[str, Any]]:
    """Spell what was measured as records, one a data set's directions and one a cell."""
    found: list[dict[str, Any]] = [
        {
            "directions": dataset,
            "sun": _spelt(one.sun, np.float64),
            "observable": _spelt(one.observable, np.bool_),
            "bound_deg": _spelt(one.bound_deg, np.float64),
        }
        for dataset, one in measured.directions.items()
    ]
    return found + [
        {
            "cell": asdict(cell),
            "error_deg": _spelt(one.error_deg, np.float32),
            "doubt": _spelt(one.doubt, np.int8),
        }
        for cell, one in measured.cells.items()
    ]


def is_sample_record(record: Mapping[str, Any]) -> bool:
    """Say whether a record is one of `sample_records`."""
    return record.keys() in (_CELL, _DIRECTIONS)


def take(record: Mapping[str, Any], measured: SampleErrors) -> None:
    """Add a record to what was measured.

    Raises
    ------
    TypeError, ValueError
        For a record that is none of `sample_records`.
    """
    if record.keys() == _CELL:
        errors = _read(record["error_deg"], np.float32), _read(record["doubt"], np.int8)
        measured.keep(Cell(**record["cell"]), CellErrors(*errors))
        return
    measured.directions[str(record["directions"])] = Directions(
        _read(record["sun"], np.float64).reshape(-1, 3),
        _read(record["observable"], np.bool_),
        _read(record["bound_deg"], np.float64),
    )


def _spelt(values: NDArray[Any], kind: type[np.generic]) -> str:
    return b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def _read(text: str, kind: type[np.generic]) -> NDArray[Any]:
    return np.frombuffer(b64decode(text, validate=True), dtype=kind)
