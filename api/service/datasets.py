"""The standard data sets: their cards, errors sample by sample, and built sensors beside them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from api.metadata.identity import identity
from api.metadata.signposting import headers, landing_of_dataset
from api.schema.datasets import (
    BuiltSensor,
    BuiltSensorRow,
    Data,
    Dataset,
    DatasetsQuery,
    RealismQuery,
    SoldSensor,
)
from api.schema.samples import SampleError, SampleErrorsQuery
from api.schema.table import columns_of
from api.schema.words import DatasetName
from api.service.documents import Document, list_document, listing
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from api.service.pagination import page
from api.service.problems import Problem
from benchmark.results import samples

if TYPE_CHECKING:
    import pandas as pd

#: Digits that a column has, at most: those of float32, of an error those that are kept.
_DIGITS = {"error_deg": 4, "bound_deg": 5, "sun_x": 7, "sun_y": 7, "sun_z": 7}


def datasets(known: Knowledge, query: DatasetsQuery) -> Document:
    """List the simulated data sets."""
    return listing(known.measurements.cards, "/v1/datasets", query, Dataset)


def dataset(known: Knowledge, name: DatasetName) -> Document:
    """Return the description of a data set and its published hashes and bounds.

    Geometry, conditions with all parameters, seeds, bounds, hashes, address of the picture. CSV:
    hashes and bounds.
    """
    card = known.measurements.card(name)
    return Document(card, columns_of(Data), lambda: card["data"], links_of(known, name))


def errors(known: Knowledge, name: DatasetName, query: SampleErrorsQuery) -> Document:
    """Return the error of every pipeline on every test sample, nominal condition.

    By extractor, model, unit and sample, with direction and bound. The whole table is
    /v1/datasets/{name}/errors.parquet.
    """
    found = choose(known.measurements, name, query)
    shown = page(range(len(found)), f"/v1/datasets/{name}/errors", query)
    return list_document(shown, rows_of(found.iloc[list(shown.items)]), SampleError, query=query)


def file(known: Knowledge, name: DatasetName, kind: str) -> bytes:
    """Return the published errors or directions of a data set's samples as Parquet.

    Raises
    ------
    Problem
        404 where they are not published.
    """
    try:
        return known.measurements.file(samples.path_of(name, directions=kind == "directions"))
    except FileNotFoundError:
        raise Problem(404, "not-published", f"no {name}.{kind}.parquet is published") from None


def links_of(known: Knowledge, name: str) -> tuple[str, ...]:
    """Return the links of a data set's content (Signposting)."""
    sampled = samples.has_samples(name, known.measurements.directory)
    landing = landing_of_dataset(name, identity(), sampled=sampled)
    return headers(landing.links_of_content())


def realism(known: Knowledge, query: RealismQuery) -> Document:
    """Compare each data set with built sensors and their published figures.

    Our accuracy is the RMS of unit 0 of the best pipeline under nominal conditions, on the standard
    bench; our precision is its repeatability. CSV: a row per data set and sensor.
    """
    chosen = [
        row
        for row in known.measurements.realism
        if not query.dataset or row["dataset"] in query.dataset
    ]
    return Document({"datasets": chosen}, columns_of(BuiltSensorRow), lambda: _built(chosen))


def as_sold(known: Knowledge) -> Document:
    """Simulate built sensors as they are sold, beside their published accuracy.

    Depth of calibration and bench are those that a sensor states, or assumed by its class; the
    error is of the statistic and the field that it states. Each row has the errors at all depths
    and on both benches.
    """
    from benchmark.as_sold.mapping import left_out  # noqa: PLC0415 - loads the simulator
    from benchmark.as_sold.record import beside_stated, tally  # noqa: PLC0415 - likewise

    items = beside_stated(known.measurements.directory)
    without = [{"hardware": name, "reason": why} for name, why in left_out().items()]
    document = {"words": tally(items), "items": items, "left_out": without}
    return Document(document, columns_of(SoldSensor), lambda: items)


def _built(chosen: list[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return [
        {**row, **sensor, "explanation": row["idealisation"] or row["sentence"]}
        for row in chosen
        for sensor in row["sensors"] or [dict.fromkeys(BuiltSensor.model_fields)]
    ]


def choose(measured: Measurements, dataset: str, query: SampleErrorsQuery) -> pd.DataFrame:
    """Return the errors of a data set that a query asks for; no rows where none are published."""
    found = measured.sample_errors(dataset)
    for name in ("extractor", "model"):
        if wanted := getattr(query, name):
            found = found[found[name].isin(wanted)]
    return found if query.unit is None else found[found["unit"] == query.unit]


def rows_of(errors: pd.DataFrame) -> list[dict[str, Any]]:
    """Return errors as rows of `SampleError`, None for NaN."""
    names = columns_of(SampleError)
    columns = [
        [_format_value(value, _DIGITS.get(name)) for value in errors[name].tolist()]
        for name in names
    ]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def _format_value(value: Any, digits: int | None) -> Any:
    if digits is None:
        return value
    return None if value != value else float(f"{value:.{digits}g}")  # noqa: PLR0124 - NaN
