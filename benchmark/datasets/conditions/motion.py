"""Frames exposed while the satellite turns, at once or row by row."""

from __future__ import annotations

from dataclasses import fields
from typing import Final

from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.preset import Condition
from benchmark.simulator.flight.spin import Spin
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.rolling_frames import RollingDiffractiveSensor

#: What student CubeSats must be able to end after their release, about any axis (requirements of
#: Stanford's AA236B); the CubeSat Design Specification wants deployers to leave less than 3.
TUMBLING: Final = Spin(30.0)
#: Seconds a pixel of a row takes to be read, of a star sensor's APS (patent CN104567864A: 82 us
#: for a row of 1024).
PIXEL_S: Final = 80e-9


def spin(
    sensor: DiffractiveFrameSensor,
    *,
    rolls: bool,
    irradiance: Irradiance = LIGHT,
) -> Condition:
    """Return the condition of a satellite that tumbles, not yet caught after its release.

    Parameters
    ----------
    sensor
        Under its nominal condition.
    rolls
        Rows are exposed one after another, as by an electronic rolling shutter that reads whole
        rows of the detector; else all together, as in a CCD of frame transfer.
    irradiance
        Of the nominal condition.
    """
    row_s = round(PIXEL_S * sensor.detector.columns, 9) if rolls else 0.0
    parts = {field.name: getattr(sensor, field.name) for field in fields(sensor)}
    order = f"row by row, {1e6 * row_s:.0f} us apart" if rolls else "all pixels together"
    return Condition(
        f"The nominal sensor on a satellite that tumbles at {TUMBLING.rate_deg_s:g} deg/s about a "
        f"random axis in each test sample; calibrated at rest. Exposure "
        f"{1e3 * sensor.detector.exposure_s:g} ms, {order}; the true direction is that at the "
        "middle of the exposure of the row through the spot.",
        RollingDiffractiveSensor(**parts, row_time_s=row_s),
        irradiance,
        spin=TUMBLING,
    )
