"""`pd-albedo-orbit`: four photodiodes in orbit, a day of orbits to learn the Earth's light on."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions.flight import Span
from benchmark.datasets.conditions.orbits import PHOTODIODES, in_orbit, photodiodes_aloft
from benchmark.datasets.standard import qpd_maskless_pyramid
from benchmark.simulator.flight.attitude import Tumble

_GROUND = replace(qpd_maskless_pyramid.PRESET, detector="PD")
_FLOWN = in_orbit(
    name="pd-albedo-orbit",
    version=3,
    drawn_as=1,
    ground=_GROUND,
    setups=photodiodes_aloft(_GROUND, PHOTODIODES),
    attitude=Tumble(24.0, nutation_deg=24.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=30.0,
    follows=(),
    description=(
        "The four photodiodes of qpd-maskless-pyramid in a sun-synchronous orbit of 600 km. "
        "Nutation moves the Sun from the boresight to 48 deg and back in 24 min. It tests "
        "Soken2023's idea, a network of four voltages trained in orbit on attitudes of other "
        "instruments; the study's geometry, orbit and training set are not known. "
        "Calibration: sunlight of one day (fifteen orbits), Earth in view. Test: three orbits "
        "a week later, the time that Soken2023's network holds. Temperature and drift as in "
        "pd-orbit."
    ),
)

#: A day and three orbits of 97 minutes.
PRESET = replace(
    _FLOWN,
    directions=replace(
        _FLOWN.flight,
        calibration=Span(start_day=0.0, samples=2880, step_s=30.0),
        test=Span(start_day=7.0, samples=870, step_s=20.0),
    ),
)
