"""alg:PDsp, PDmp and PPE transcribed on lines of pixels."""

from __future__ import annotations

import numpy as np

from algorithms.extractors.profiles.peak_detection import FramePeak, PeakDetection
from algorithms.extractors.profiles.peak_position import SLIT_IMAGE, PeakPositionEstimate

PIXELS = 61


def pd_sp_as_printed(line):
    """alg:PDsp: ``argmax_n I[n]``."""
    n_peak = 0
    for n, value in enumerate(line):
        if value > line[n_peak]:
            n_peak = n
    return n_peak


def pd_mp_as_printed(line, offsets):
    """alg:PDmp: ``argmax_n min_i I[n + d_i]``, where all of the pattern is on the line."""
    best, n_peak = -np.inf, None
    for n in range(-min(offsets), len(line) - max(offsets)):
        least = min(line[n + d] for d in offsets)
        if least > best:
            best, n_peak = least, n
    return n_peak


def lines_of(count, seed):
    """Lines whose every pixel differs from all others: nothing is left to chance."""
    rng = np.random.default_rng(seed)
    return np.array([rng.permutation(2 * PIXELS).reshape(2, PIXELS) for _ in range(count)])


def test_pd_of_one_slit():
    lines = lines_of(20, 1)
    method = PeakDetection(("x", "y"), PIXELS, ((0.0, 0.0, 3.0),), reach_px=20.0, margin_px=2.0)
    expected = [[pd_sp_as_printed(line) for line in profile] for profile in lines]
    np.testing.assert_array_equal(method.extract(lines.reshape(20, -1)), expected)


def test_pd_of_several_slits():
    lines, offsets = lines_of(20, 2), (-14, -5, 0, 9)
    slits = tuple((float(d), 0.0, 3.0) for d in offsets)
    method = PeakDetection(("x", "y"), PIXELS, slits, reach_px=20.0, margin_px=2.0)
    expected = [[pd_mp_as_printed(line, offsets) for line in profile] for profile in lines]
    np.testing.assert_array_equal(method.extract(lines.reshape(20, -1)), expected)


def test_pd_of_a_frame():
    """alg:PDsp on both axes at once."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        frame = rng.permutation(19 * 23).reshape(19, 23)
        y, x = divmod(pd_sp_as_printed(frame.ravel()), 23)
        np.testing.assert_array_equal(FramePeak().extract(frame[None]), [[x, y]])


def image_model(u):
    """``I_mdl1`` of alg:PPE and its derivative; u in half widths, as the coefficients are."""
    c1, c2, c3, c4, c5, c6 = SLIT_IMAGE
    top, bottom = c1 * u**4 + c2 * u**2 + c3, c4 * u**4 + c5 * u**2 + c6
    slope = (4 * c1 * u**3 + 2 * c2 * u) / bottom
    slope -= top * (4 * c4 * u**3 + 2 * c5 * u) / bottom**2
    return top / bottom, slope


def ppe_as_printed(line, half, places, start, overlapping=()):
    """alg:PPE: Gauss-Newton steps on ``(a_1, a_2, b_1, b_2, m_x, m_y)``.

    `places` are those of A, B, C and D at zero shift, `overlapping` the two of one amplitude (image
    types 1 to 4). Pixels count up to eight half widths from a peak.
    """
    column = [0, 1, 2, 3]
    if overlapping:
        first, second = overlapping
        left = [n for n in range(4) if n != second]
        column = [left.index(first if n == second else n) for n in range(4)]
    amplitudes = 4 - bool(overlapping)
    floor = float(np.median(line))
    shifts = list(start)
    a = [line[round(places[n] + shifts[n // 2])] - floor for n in range(4)]
    parameters = np.array([a[column.index(m)] for m in range(amplitudes)] + shifts)
    for _ in range(60):
        rows, errors = [], []
        for tau, light in enumerate(line):
            model = 0.0
            row = np.zeros(len(parameters))
            for n in range(4):
                m = amplitudes + n // 2
                u = (tau - places[n] - parameters[m]) / half
                if abs(tau - places[n] - start[n // 2]) > 8.0 * half:
                    continue
                value, slope = image_model(u)
                model += parameters[column[n]] * value
                row[column[n]] += value
                row[m] -= parameters[column[n]] * slope / half
            if row.any():
                rows.append(row)
                errors.append(light - floor - model)
        q = np.array(rows)
        step = np.linalg.solve(q.T @ q, q.T @ np.array(errors))
        parameters = parameters + step  # ERRATA: the update that the survey leaves out
        if np.abs(step[amplitudes:]).max() < 1e-9:
            break
    return parameters[amplitudes:]


def crossed(shifts, seed):
    """A line behind two pairs of slits, one of slant 45 deg; positions of A, B, C, D."""
    half, offsets = 3.0, (-40.0, -20.0, 30.0, 62.0)
    slits = tuple((d, float(n > 1), 2 * half) for n, d in enumerate(offsets))
    method = PeakPositionEstimate(("x",), 181, slits, reach_px=60.0, margin_px=2.0)
    places = [90.0 + d for d in offsets]
    tau = np.arange(181)
    rng = np.random.default_rng(seed)
    line = 30.0 + rng.normal(0, 3.0, 181)
    for n, place in enumerate(places):
        line += (400 - 30 * n) * image_model((tau - place - shifts[n // 2]) / half)[0]
    return method, places, half, line


def test_ppe_of_peaks_apart():
    for seed, shifts in enumerate([(0.3, -0.8), (-6.4, 4.7), (8.2, 9.9)]):
        method, places, half, line = crossed(shifts, seed)
        found, pairs = method.fit(line[None])
        assert (pairs == -1).all()  # image type 0
        start = [round(shift) for shift in shifts]
        expected = ppe_as_printed(line, half, places, start)
        np.testing.assert_allclose(found[0], expected, rtol=0, atol=0.01)


def test_ppe_of_peaks_on_each_other():
    """Image type 2: B and C overlap and share their amplitude."""
    shifts = (27.3, -22.2)
    method, places, half, line = crossed(shifts, 5)
    assert abs(places[1] + shifts[0] - places[2] - shifts[1]) < half
    found, pairs = method.fit(line[None])
    assert pairs[0].tolist() == [1, 2]
    expected = ppe_as_printed(line, half, places, [27, -22], (1, 2))
    np.testing.assert_allclose(found[0], expected, rtol=0, atol=0.03)
