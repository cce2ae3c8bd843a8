"""Feature extractors and calibration models of the sun-sensor literature.

Readable and usable alone: nothing here knows of the survey's tables, the benchmark or the
service. Start at `algorithms.contract`; every implementation is one class in one module of
`algorithms.extractors` or `algorithms.models`.
"""
