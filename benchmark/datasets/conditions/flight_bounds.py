"""Posterior bounds of flights: for filters, and for who reads other instruments aboard."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, cast

from algorithms.contract import Floats
from benchmark.datasets.conditions.flight_unknowns import Same, unknowns
from benchmark.datasets.conditions.instruments import Instruments
from benchmark.metrics.bounds import Bound
from benchmark.metrics.posterior_bound import (
    Motion,
    attitude_information,
    recursive_bound,
    single_bound,
    sun_information,
    vector_information,
)
from benchmark.simulator.flight.attitude import rotate

#: What who uses a magnetometer, or a horizon sensor, must know: what it reads, the same in the
#: inertial frame, and the Sun there.
MAGNETOMETER = frozenset({"magnetic_field_nT", "magnetic_field_inertial_nT", "sun_inertial"})
HORIZON = frozenset({"nadir", "nadir_inertial", "sun_inertial"})


def posterior_bound(
    preset: Any,
    condition: str,
    context_columns: frozenset[str],
    *,
    sequential: bool,
    bound: Bound | None = None,
    unit_known: bool = True,
) -> Floats | None:
    """Bound (N,) of the test split, degrees, for pipelines that a sample's own bound is not for.

    Light from the Earth counts as known, and so do the unit and its drift, as in the bound of one
    sample, unless `unit_known` is False: then they are `Unknowns`. A sequential
    pipeline knows all readings up to each sample, the gyroscope's among them, and the strength of
    sunlight. A magnetometer's and a horizon sensor's readings count where the pipeline
    reads their counterparts in the inertial frame and the almanac's Sun, too (nadir alone says
    nothing of the Sun); of their errors only the white noise is unknown.

    Parameters
    ----------
    preset, condition
        A data set's.
    context_columns
        Columns of the context that the pipeline reads, of all its stages.
    sequential
        Whether it carries a state from sample to sample.
    bound
        That of one sample, of the test split, where it is known already; else it is computed.
    unit_known
        Whether the unit, its drift and creep are.

    Returns
    -------
    ndarray, shape (N,), or None
        inf where nothing is known of the direction. None where the data set is no flight, or the
        pipeline is bound by one sample's own bound.

    Raises
    ------
    ValueError
        On an unknown condition, or a bound without Fisher matrices.
    """
    magnetometer, horizon = context_columns >= MAGNETOMETER, context_columns >= HORIZON
    flight = getattr(preset, "flight", None)
    if flight is None or not (sequential or magnetometer or horizon):
        return None
    single: Bound = preset.bound(condition, "test") if bound is None else bound
    if single.fisher is None:
        raise ValueError("a posterior bound needs a bound with Fisher matrices (cramer_rao)")
    return _posterior(
        Same(preset), condition, Same(single), sequential, magnetometer, horizon, unit_known
    )


# every model of a board that reads the same instruments asks for the same one
@lru_cache(maxsize=8)
def _posterior(  # noqa: PLR0917 - lru_cache tells calls by place and by name apart
    kept_preset: Same,
    condition: str,
    kept_bound: Same,
    sequential: bool,
    magnetometer: bool,
    horizon: bool,
    unit_known: bool,
) -> Floats:
    """Return the bound as `posterior_bound`, which says what is known; read-only."""
    preset, single = kept_preset.it, kept_bound.it
    flight = preset.flight
    leg = flight.leg("test")
    own = None if unit_known else unknowns(preset, condition)
    if own is None:
        read, known = sun_information(single.fisher, irradiance_known=sequential), None
    elif sequential:
        read, known = own.information(irradiance_known=True), own.known
    else:
        read, known = own.direction(irradiance_known=False), None
    information = attitude_information(leg.sun_body, read)
    if magnetometer:
        field_nt = rotate(leg.turn, _true_field_nt(preset, condition, leg))
        information[:, :3, :3] += vector_information(field_nt, flight.magnetometer_nt)
    if horizon:
        deviation = math.tan(math.radians(flight.horizon_deg))
        information[:, :3, :3] += vector_information(leg.nadir_body, deviation)
    if sequential:
        motion = Motion(leg.turn, leg.time_s, flight.gyro)
        found = recursive_bound(leg.sun_body, information, motion, known)
    else:
        found = single_bound(leg.sun_body, information)
    found.flags.writeable = False
    return found


def _true_field_nt(preset: Any, condition: str, leg: Any) -> Floats:
    """(N, 3) inertial frame: the model's, and what it leaves out."""
    aboard = cast("Instruments | None", preset.condition(condition).bench)
    known: Floats = leg.field_nt
    if aboard is None:
        return known
    distance = leg.orbit.distance_km
    missing = aboard.missing_field(distance, *preset.streams)
    return known + missing.inertial(-leg.nadir, distance, leg.time_s)
