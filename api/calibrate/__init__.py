"""From a turntable file to a calibrated sensor: read, diagnose, choose a model, judge, export.

`api.calibrate.calibration.calibrate` does it all; each step is a module of its own.
"""
