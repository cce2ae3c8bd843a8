"""From a turntable file to a calibrated sensor: read, diagnose, choose a model, judge, export.

`calibrate` takes files, `calibrate_arrays` readings and directions in memory, and
`calibrate_frame` a data frame; each step is a module of its own.
"""

from calibrate.arrays import CalibratedSensor, calibrate_arrays, calibrate_frame
from calibrate.calibration import Calibration, calibrate

__all__ = ["CalibratedSensor", "Calibration", "calibrate", "calibrate_arrays", "calibrate_frame"]
