"""Results as plain files that live in git, compact and compared line by line.

A store is a directory:

- ``scores/<dataset>.csv``: one row a pipeline, condition and unit; numbers only.
- ``samples/<dataset>.parquet``: the errors behind scores, sample by sample
  (`benchmark.results.samples`).
- a file of each recorded experiment (`benchmark.running.experiment`).
- ``pins.csv``: hash and bound of each generated split.
- ``components.json``: facts and digests of what the numbers are of.
- ``checksums-sha256.txt``: of all these, by which a change by hand shows (`files.manifest`).

All depend on code and data only, never on time or machine. A running runner keeps its progress in
``.sunatlas/journal.jsonl`` (`benchmark.results.record`).
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.contract import SPLITS, Cell
from benchmark.datasets.pins import BOARD_FACTS, Pin, Place
from benchmark.metrics.score import METRICS
from benchmark.results import record_manifest
from benchmark.results.components import Components, ComponentsError, Facts
from benchmark.results.csv_tables import (
    Reader,
    Row,
    StoreError,
    above_zero,
    count,
    number,
    one_of,
    read_csv,
    share,
    size,
    text_of,
    word,
)
from survey_data.nearest import nearest_name

if TYPE_CHECKING:
    import pandas as pd

Filter = str | Collection[str] | None

PUBLISHED = Path(__file__).parents[1] / "published"
#: Of the sensors of single studies: a record of its own, for no board compares anything there.
PUBLISHED_STUDIES = Path(__file__).parents[1] / "published_studies"

STATUSES = ("ok", "refused", "failed")


#: What a score says, beside which cell it is of.
NUMBERS = ("status", *METRICS, "reason")
_SCORE_COLUMNS: Mapping[str, Reader] = {
    "condition": word,
    "extractor": word,
    "model": word,
    "unit": count,
    "status": one_of(*STATUSES),
    **dict.fromkeys(METRICS, size),
    **dict.fromkeys(("availability", "false_detection_rate"), share),
    **dict.fromkeys(("bias_alpha_deg", "bias_beta_deg"), number),
    "reason": str,
}


class UnknownFieldError(LookupError):
    """A query names a field that results do not have; the message names the nearest."""


class Store:
    """Results in a directory, by default the published ones; made on the first write."""

    def __init__(self, directory: Path | str = PUBLISHED) -> None:
        self.directory = Path(directory)

    @property
    def scores_directory(self) -> Path:
        """Where the tables of scores are."""
        return self.directory / "scores"

    @property
    def samples_directory(self) -> Path:
        """Where the errors sample by sample are."""
        return self.directory / "samples"

    @property
    def pins_path(self) -> Path:
        """Of the table of pins."""
        return self.directory / "pins.csv"

    @property
    def components_path(self) -> Path:
        """Of the components' facts and digests."""
        return self.directory / "components.json"

    @property
    def work_directory(self) -> Path:
        """Where a runner keeps its progress and its lock; not part of the results."""
        return self.directory / ".sunatlas"

    def components(self) -> Components:
        """Return what the stored numbers are of; ComponentsError for a file that is none."""
        return Components.read(self.components_path)

    def scores(self) -> dict[Cell, Row]:
        """Return stored numbers by cell, sorted; nothing where there are no files.

        StoreError for a line that is no row of scores, or one that is there twice.
        """
        folder = self.scores_directory
        if os.path.lexists(folder) and not folder.is_dir():
            raise StoreError(f"{folder}: expected a directory of tables")
        found: dict[Cell, Row] = {}
        for path in sorted(self.scores_directory.glob("*.csv")):
            for line, row in read_csv(path, _SCORE_COLUMNS):
                if row["unit"] is None:
                    raise StoreError(f"{path}, line {line}: expected a number in unit")
                names = (row.pop(name) for name in ("condition", "extractor", "model", "unit"))
                cell = Cell(path.stem, *names)
                if cell in found:
                    raise StoreError(f"{path}, line {line}: {cell} is there twice")
                found[cell] = row
        return {cell: found[cell] for cell in sorted(found)}

    def rows(self, unit: int | None = 0) -> list[Row]:
        """Return scores with all that is known of what they are of, sorted; of all units for None.

        StoreError, ComponentsError for a file that cannot be read, or names what the others lack.
        """
        return describe(self.scores(), self.components(), self.pins(), unit)

    def pins(self) -> dict[Place, Pin]:
        """Pinned data by (dataset, condition, split); StoreError for a line that is no pin."""
        return read_pins(self.pins_path)

    def query(self, **where: Filter) -> list[Row]:
        """Return the rows whose fields have one of the wanted values.

        ``query(dataset="x", model=["a", "b"])``; a filter of None is no filter. Of the standard
        unit. UnknownFieldError for a field that no row has.
        """
        rows = self.rows()
        known = {name for row in rows for name in row} or set(_IDENTITY)
        wanted = {}
        for field, values in where.items():
            if field not in known:
                close = nearest_name(field, known)
                hint = f"did you mean {close!r}?" if close else f"known: {sorted(known)}"
                raise UnknownFieldError(f"results have no field {field!r}; {hint}")
            if values is not None:
                wanted[field] = {values} if isinstance(values, str) else set(values)
        return [row for row in rows if all(row.get(f) in some for f, some in wanted.items())]

    def frame(self, **where: Filter) -> pd.DataFrame:
        """`query(**where)` as a pandas frame."""
        import pandas as pd  # noqa: PLC0415 - half a second that most readers do not need

        return pd.DataFrame(self.query(**where))

    def write(
        self,
        scores: Mapping[Cell, Row],
        pins: Iterable[Pin],
        components: Components,
    ) -> None:
        """Replace the files, each whole or not at all; unchanged ones are left alone.

        Components come last: numbers that a crash leaves beside the digests of older code are
        measured again. Scores are numbers (`NUMBERS`) by cell.
        """
        tables = {}
        for dataset, group in groupby(sorted(scores), key=lambda cell: cell.dataset):
            rows = [
                {
                    "condition": cell.condition,
                    "extractor": cell.extractor,
                    "model": cell.model,
                    "unit": cell.unit,
                    **scores[cell],
                }
                for cell in group
            ]
            tables[dataset] = text_of(list(_SCORE_COLUMNS), rows)
        folder = self.scores_directory.name
        contents: dict[str, str | None] = {
            f"{folder}/{name}.csv": text for name, text in tables.items()
        }
        for path in self.scores_directory.glob("*.csv"):
            contents.setdefault(f"{folder}/{path.name}", None)
        contents[self.pins_path.name] = pins_text(pins)
        contents[self.components_path.name] = components.text()
        record_manifest.write(self.directory, contents, start=True)


def describe(
    scores: Mapping[Cell, Row],
    components: Components,
    pins: Mapping[Place, Pin],
    unit: int | None = None,
) -> list[Row]:
    """Return scores with all that is known of what they are of, as `Store.rows`."""
    return [
        _described(cell, scores[cell], components, pins)
        for cell in sorted(scores)
        if unit is None or cell.unit == unit
    ]


_IDENTITY = ("dataset", "condition", "extractor", "model", "unit", "status")


def _described(cell: Cell, numbers: Row, components: Components, pins: Mapping[Place, Pin]) -> Row:
    dataset, extractor, model = (
        _facts(components, kind, name, cell)
        for kind, name in (
            ("datasets", cell.dataset),
            ("extractors", cell.extractor),
            ("models", cell.model),
        )
    )
    calibration, test = (
        pins.get((cell.dataset, cell.condition, split)) for split in ("calibration", "test")
    )
    return {
        "dataset": cell.dataset,
        "dataset_version": dataset["version"],
        "condition": cell.condition,
        "unit": cell.unit,
        "detector": dataset["detector"],
        "mask": dataset["mask"],
        "half_fov_deg": dataset["half_fov_deg"],
        "extractor": cell.extractor,
        "extractor_taxonomy": extractor["taxonomy"],
        "extractor_version": extractor["version"],
        "model": cell.model,
        "model_taxonomy": model["taxonomy"],
        "model_version": model["version"],
        "status": numbers["status"],
        "reason": numbers["reason"],
        "n_calibration": calibration.n if calibration else None,
        "n_test": test.n if test else None,
        "n_observable": test.observable if test else None,
        **{name: numbers[name] for name in METRICS},
        "metric_version": components.metric,
    }


def _facts(components: Components, kind: str, name: str, cell: Cell) -> Facts:
    known: Mapping[str, Facts] = getattr(components, kind)
    if name not in known:
        raise ComponentsError(f"the score of {cell} names {name!r}, unknown among the {kind}")
    return known[name]


_COLUMNS = {
    "dataset": word,
    "condition": word,
    "split": one_of(*SPLITS),
    "version": count,
    "n": count,
    "observable": count,
    "bound_deg": above_zero,
    "head_bound_deg": above_zero,
    **dict.fromkeys(BOARD_FACTS, size),
    "data_hash": word,
    "head_hash": word,
}


def pins_text(pins: Iterable[Pin]) -> str:
    """Spell pins as their file has them, sorted."""
    ordered = sorted(pins, key=lambda pin: pin.place)
    return text_of(list(_COLUMNS), map(asdict, ordered))


def read_pins(path: Path) -> dict[Place, Pin]:
    """Read pins by place; StoreError naming the line that is none, or that is there twice."""
    found: dict[Place, Pin] = {}
    for line, row in read_csv(path, _COLUMNS):
        missing = [name for name in ("version", "n") if row[name] is None]
        if missing:
            raise StoreError(f"{path}, line {line}: expected a number in {', '.join(missing)}")
        pin = Pin(**row)
        if pin.place in found:
            raise StoreError(f"{path}, line {line}: {'/'.join(pin.place)} is there twice")
        found[pin.place] = pin
    return found
