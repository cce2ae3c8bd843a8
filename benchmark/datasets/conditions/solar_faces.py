"""Solar cells on the faces of a satellite: panels of several, or single ones; conditions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from benchmark.datasets.conditions.faces import albedo, noises
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.preset import Condition
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.sensors.face_layouts import Normals
from benchmark.simulator.sensors.solar_cells import SolarCells, SolarCellSensor


@dataclass(frozen=True)
class _Words:
    what: str
    new: str
    cosine: str
    aged: str


_PANELS = _Words(
    "panels",
    "New panels of two cells in series, matched to 2 %",
    "with cells that follow Lambert's cosine",
    "cells have lost 20 % of their current, 5 % more or less from cell to cell, and the weaker one "
    "of a panel counts",
)
_CELLS = _Words(
    "cells",
    "New cells, matched to 2 %",
    "with Lambert's cosine",
    "20 % of the current lost, 5 % more or less from cell to cell",
)


def cells_on(normals: Normals, sunlit_ua: float, in_series: int = 1) -> SolarCellSensor:
    """Return new cells, `in_series` of them a face, with amplifiers for Sun and Earth together."""
    return SolarCellSensor(
        normals=normals,
        readout=CurrentReadout(
            sunlit_ua=sunlit_ua,
            gain_mismatch=0.01,
            noise_ua=sunlit_ua / 1000.0,
            full_scale_ua=2.0 * sunlit_ua,
            bits=12,
        ),
        cells=SolarCells(
            in_series=in_series,
            mismatch=0.02,
            temperature_per_k=0.0006,
            temperature_c=25.0,
            heating_k=40.0,
        ),
        normal_error_deg=0.2,
    )


def solar_conditions(sensor: SolarCellSensor, body: str = "sphere") -> dict[str, Condition]:
    """Return the conditions of panels where cells are in series, else of single cells on a body."""
    cells = sensor.cells
    off = "their faces'" if cells.in_series > 1 else f"the {body}'s"
    words = _PANELS if cells.in_series > 1 else _CELLS
    what = words.what
    seen = partial(Condition, irradiance=LIGHT)
    later = partial(since_calibration, new=sensor, light=LIGHT)
    return {
        "nominal": seen(
            f"{words.new}, 40 K warmer in full sunlight than in the dark; Kelly response, noise of "
            "1e-3 of full sunlight, no Earth.",
            sensor,
        ),
        "cosine": seen(f"The nominal {what} {words.cosine}.", replace(sensor, response="cosine")),
        **noises(sensor, what, "a 16-bit"),
        "misaligned": seen(
            f"The nominal {what} mounted 2 deg off {off} normals.",
            replace(sensor, normal_error_deg=2.0),
        ),
        **later(
            "hot",
            f"The nominal {what} 55 K warmer: currents 3.3 % higher",
            replace(sensor, cells=replace(cells, temperature_c=80.0)),
        ),
        **later(
            "cold",
            f"The nominal {what} 85 K colder: currents 5.1 % lower",
            replace(sensor, cells=replace(cells, temperature_c=-60.0)),
        ),
        **later(
            "aged",
            f"The nominal {what} after years in orbit: {words.aged}",
            replace(sensor, cells=replace(cells, loss=0.2, loss_spread=0.05)),
        ),
        "albedo": albedo(sensor, what),
    }
