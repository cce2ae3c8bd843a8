"""Built sensors simulated as they are sold: their calibration, bench, statistic and field."""
