"""What a reading tells of its mean when it comes in whole codes between two ends.

A converter gives ``k = round(mu + sigma z)``, clipped to the codes it has. Of the mean mu such a
reading holds the Fisher information

    I(mu, sigma) = sum_k (dP_k / dmu)^2 / P_k,
    P_k = Phi((k + 1/2 - mu) / sigma) - Phi((k - 1/2 - mu) / sigma),

where the two ends take all that lies beyond them. Its inverse is what an efficient estimator has
for the reading's variance. With noise above a code it is ``sigma^2 + 1/12``, whatever mu: the
difference is 5e-5 of it at sigma = 0.8 and falls with sigma^-4. With less noise it depends on
where mu falls between two edges: near the edge a reading tells more than that (sigma^2 pi / 2 on
the edge itself, for noise far below a code), in the middle of a code next to nothing.

That the noise itself grows with the signal is left out, as it is in the bounds: it would add one
part in twice the number of electrons.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.readout.detectors import PixelArray

#: What rounding adds to the variance where the noise is larger than a code.
ROUNDING = 1.0 / 12.0


def reading_variance(mean: Floats, deviation: Floats, lowest: float, highest: float) -> Floats:
    """Inverse Fisher information of readings on their means, in squared codes.

    Parameters
    ----------
    mean, deviation
        Of the signal before rounding, in codes; arrays of one shape, or that broadcast to one.
        Neither may be NaN.
    lowest, highest
        Codes at which the converter ends.

    Returns
    -------
    Floats
        Within 1e-3 of the sum above, and 3e-3 where an end of the scale takes part of it; inf
        where the reading cannot change, as beyond the scale or in the middle of a code with
        hardly any noise.

    Raises
    ------
    ValueError
        Unless `highest` is above `lowest`.
    """
    from benchmark.simulator.kernels.quantising import reading_variances, table  # noqa: PLC0415 - Numba on demand

    if not highest > lowest:
        raise ValueError(f"highest must be above lowest = {lowest}; got {highest}")
    means, deviations = np.broadcast_arrays(mean, deviation)
    flat = np.empty(means.size)
    reading_variances(
        flat,
        np.ascontiguousarray(means, dtype=np.float64).reshape(-1),
        np.ascontiguousarray(deviations, dtype=np.float64).reshape(-1),
        (float(lowest), float(highest)),
        table(),
    )
    return flat.reshape(means.shape)


def pixel_variance(detector: PixelArray, expected: Floats) -> Floats:
    """Squared digital numbers of pixels whose mean reading is `expected`: shot noise and reading.

    The scale ends at 0 and at the full well or the converter's last code, whichever is lower.
    Amplifiers that bend the signal bend its noise; of their columns' offsets nothing is known
    here, so that they count as charge: beside the read noise, next to nothing. Noise that a
    column's pixels share is `benchmark.simulator.readout.column_noise`'s.
    """
    electrons = np.maximum((expected - detector.offset_dn) * detector.gain_e_per_dn, 0.0)
    errors, per_dn = detector.errors, detector.gain_e_per_dn
    if errors.nonlinearity or detector.apart_noise_e:
        held = errors.held(electrons, detector.full_well_e)
        bent = errors.slope(held, detector.full_well_e)
        single = bent**2 * (held + detector.read_noise_e**2) + detector.apart_noise_e**2
        return reading_variance(
            expected, np.sqrt(single) / per_dn, 0.0, float(detector.last_code_dn)
        )
    return _of_electrons(detector, expected, electrons, detector.last_code_dn)


def charge_variance(detector: PixelArray, charge_e: Floats, shot_e: Floats) -> Floats:
    """Squared electrons of pixels that are read out with a mean of `charge_e`.

    `shot_e` is the variance of the charge itself. The scale ends at 0 and at the converter's last
    code: what becomes of a full well is its sensor's to say.
    """
    per_dn = detector.gain_e_per_dn
    numbers = detector.offset_dn + charge_e / per_dn
    return per_dn**2 * _of_electrons(detector, numbers, shot_e + 0.0, detector.full_scale_dn)


def _of_electrons(
    detector: PixelArray, numbers: Floats, electrons: Floats, last_code: int
) -> Floats:
    """Squared digital numbers of means `numbers`; the shot noise's `electrons` are overwritten."""
    electrons += detector.read_noise_e**2
    np.sqrt(electrons, out=electrons)
    electrons /= detector.gain_e_per_dn
    return reading_variance(numbers, electrons, 0.0, float(last_code))
