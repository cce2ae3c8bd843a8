"""A maximum-likelihood direction of a known unit whose amplifiers err; for tests alone.

As `most_likely`, with its chances of whole codes: the mean signal's light comes of the sensor with
its amplifiers' errors off, and bend, offsets and the noise of columns are written down anew. That
noise is estimated along with the direction, one number a column, under its normal prior.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from most_likely import Floats, _score, of_window

from benchmark.datasets import Condition
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene


def errors_deg(setup: Condition, one: Scene, names: tuple[str | int, ...], trials: int) -> Floats:
    """(trials, 2) errors along two tangent axes; every trial draws light, stray light and noise."""
    sensor: Any = setup.sensor
    detector, errors, light = sensor.detector, sensor.detector.errors, setup.irradiance
    unit = sensor.fixed_pattern("test", *names, 0)
    drawn, stray = light.draw(trials, generator("test", *names, "light"))
    streams = NoiseStreams.named("test", *names, "noise")
    many = Scene(
        np.repeat(one.sun, trials, 0),
        drawn,
        stray,
        None if one.origin_px is None else np.repeat(one.origin_px, trials, 0),
    )
    seen = sensor.observe(many, unit, streams)
    width = seen.shape[-1]
    shared = seen.ndim == 3 and errors.column_noise_e > 0
    codes = seen.reshape(trials, -1).astype(float)
    per_dn, well = detector.gain_e_per_dn, detector.full_well_e
    straight = replace(errors, nonlinearity=0.0, column_offset_e=0.0, column_noise_e=0.0)
    plain = replace(sensor, detector=replace(detector, errors=straight))
    bare = {k: v for k, v in unit.items() if k != "column_e"}
    offset = np.zeros(codes.shape[1])
    if "column_e" in unit:
        first = 0 if one.origin_px is None else int(one.origin_px[0, 0])
        own = unit["column_e"][first : first + width]
        offset = np.tile(own, codes.shape[1] // width)
    assert of_window(unit["gain"], one, seen.shape[1:]).shape == offset.shape
    bend = errors.nonlinearity / well
    last = min(
        2.0**detector.bits - 1, np.rint(detector.offset_dn + well * (1 - bend * well) / per_dn)
    )
    first_axis, second_axis = tangent_axes(one.sun)

    def held(p: Floats) -> Floats:
        """(N, M) electrons for offsets (rad), irradiance and stray light."""
        sun = one.sun + p[:, :1] * first_axis + p[:, 1:2] * second_axis
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        origin = None if one.origin_px is None else np.repeat(one.origin_px, len(p), axis=0)
        numbers = plain.expected(Scene(sun, p[:, 2], p[:, 3], origin), bare)
        return np.asarray((numbers.reshape(len(p), -1) - detector.offset_dn) * per_dn)

    typical = np.array([0.0, 0.0, 1.0, light.stray])
    prior = np.array([0.0, 0.0, light.spread**-2, light.stray_spread**-2])
    steps = np.array([3e-4, 3e-4, 0.01, light.stray_spread])
    swept = held(typical + np.concatenate([np.diag(steps), -np.diag(steps)]))
    slopes = (swept[:4] - swept[4:]) / (2 * steps[:, None])
    guess = np.repeat([typical], trials, axis=0)
    common = np.zeros((trials, width))
    apart = 0.0 if shared else errors.column_noise_e
    for _ in range(5):
        charge = held(guess)
        bent = 1 - 2 * bend * charge
        read = charge * (1 - bend * charge) + offset + np.tile(common, codes.shape[1] // width)
        mean = detector.offset_dn + read / per_dn
        spread = bent**2 * (charge + detector.read_noise_e**2) + apart**2
        score, weight = _score(codes, mean, np.sqrt(spread) / per_dn, (0.0, last))
        own = slopes[None] * bent[:, None, :] / per_dn
        column = (per_dn, errors.column_noise_e, common) if shared else None
        move, pushed = _moves(own, (score, weight), (prior, guess - typical), column)
        guess = guess + move
        common = common + pushed
    return np.degrees(guess[:, :2])


def _moves(
    own: Floats,
    given: tuple[Floats, Floats],
    known: tuple[Floats, Floats],
    column: tuple[float, float, Floats] | None,
) -> tuple[Floats, Floats | float]:
    """One step of Newton's: of the parameters (N, 4), and of the columns' noise (N, W).

    `own` (N, 4, M) are slopes of the mean, `given` score and weight of the readings, `known` the
    prior's weight and how far the guess is from it, `column` the gain, and spread and guess of
    the columns' noise.
    """
    score, weight = given
    prior, away = known
    left = np.einsum("nim,nm,njm->nij", own, weight, own) + np.diag(prior)
    right = np.einsum("nim,nm->ni", own, score) - prior * away
    if column is None:
        return np.linalg.solve(left, right[:, :, None])[:, :, 0], 0.0
    per_dn, spread, common = column
    count, width = common.shape
    # the columns' share is solved for first (Schur's complement)
    rows = (count, -1, width)
    theirs = weight.reshape(rows).sum(axis=1) / per_dn**2 + spread**-2
    push = score.reshape(rows).sum(axis=1) / per_dn - common * spread**-2
    mixed = (own * weight[:, None, :]).reshape(count, 4, -1, width).sum(axis=2) / per_dn
    left -= np.einsum("nik,njk->nij", mixed / theirs[:, None, :], mixed)
    right -= np.einsum("nik,nk->ni", mixed, push / theirs)
    move = np.linalg.solve(left, right[:, :, None])[:, :, 0]
    return move, (push - np.einsum("nik,ni->nk", mixed, move)) / theirs
