"""Committed numbers beside measured ones: what differs, and what is rounding."""

from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.contract import Cell
from benchmark.leaderboard.check import compare_scores
from benchmark.metrics.rings import RINGS
from benchmark.metrics.score import METRICS

CELL = Cell("fake-diodes", "noisy", "fake-currents", "fake-least-squares")


def differences(column, value, measured, **row):
    """Compare one number with another measured; 400 samples."""
    base = {"status": "ok", **dict.fromkeys(METRICS), "reason": "", "rms_deg": 0.5, **row}
    committed, found = {CELL: {**base, column: value}}, {CELL: {**base, column: measured}}
    counted = {("fake-diodes", "noisy"): 400}
    return [d.cell for d in compare_scores(committed, found, counted)]


def test_accuracy_is_compared_within_a_ten_thousandth_and_shares_within_a_sample():
    assert differences("median_deg", 0.5, 0.5 * (1 + 9e-5)) == []
    assert differences("median_deg", 0.5, 0.5 * (1 + 2e-4)) == [f"{CELL}/median_deg"]
    assert differences("availability", 1.0, 1 - 1 / 400) == []
    assert differences("availability", 1.0, 1 - 2 / 400) == [f"{CELL}/availability"]
    assert differences("false_detection_rate", None, 0.0) == [f"{CELL}/false_detection_rate"]
    assert differences("rms_deg", None, 0.5) == [f"{CELL}/rms_deg"]
    assert differences("status", "ok", "failed") == [f"{CELL}/status"]
    # a mean near zero is as uncertain as the spread it averages
    assert differences("bias_alpha_deg", 1e-9, -4e-5) == []
    assert differences("bias_alpha_deg", 1e-9, -6e-5) == [f"{CELL}/bias_alpha_deg"]


COLUMNS = [name for name in METRICS if name not in ("availability", "false_detection_rate")]


@settings(deadline=None, derandomize=True)
@given(
    column=st.sampled_from([name for name in COLUMNS if not name.startswith("bias_")]),
    value=st.floats(1e-9, 180.0),
    factor=st.floats(1.0, 1.1),
)
def test_a_fifth_of_a_percent_is_found_in_every_column_and_rounding_in_none(column, value, factor):
    digits = 4 if column in {ring.column for ring in RINGS} else 5
    one, other = (float(f"{v:.{digits}g}") for v in (value, value * factor))
    found = bool(differences(column, one, other))
    if factor > 1.0021:  # the step of a number of four digits, and the tolerance
        assert found
    if abs(factor - 1.0) < 1e-5:
        assert not found
