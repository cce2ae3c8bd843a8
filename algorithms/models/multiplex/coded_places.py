"""Beyond the survey: coded masks whose apertures' places are learned with known directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.coded.built_places import BuiltMask
from algorithms.calibration.coded.mask import NEEDS, CodedMask, Search
from algorithms.calibration.forward import ForwardModel
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.spot_lists import SPOT_COLUMNS


@documented
@dataclass
class CodedPlaces(BuiltMask, CodedMask):
    """Code read by correlation; places of apertures by the calibration's directions and spots.

    Where `CodedCorrelation` learns how apertures lie to each other from spots of one frame alone,
    each known direction says here where all its spots should be. Apertures seen often count more.

    Notes
    -----
    Implements: nothing printed in the survey; see `algorithms.calibration.coded.built_places`. A
    direction is that of the weighed mean of its spots, weights one over the variance of spot and
    hole, so that a hole that the calibration never showed has little part in it.

    Failure: a NaN row for a NaN feature row, outside the cone of calibrated directions, beyond the
    field of view, where fewer than `agreeing` spots agree, and where another place explains the
    spots nearly as well. fit raises UnusableDataError where the code is read in less than half of
    the samples, and below 5 samples.

    Cost: that of `CodedCorrelation`; the fit, 12 inversions of a matrix of all apertures.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import coded_design, coded_lists, sun_grid
    >>> sun = sun_grid(range(-40, 41, 10))
    >>> model = CodedPlaces(**coded_design()).fit(coded_lists(sun), sun)
    >>> angles_from_sun(model.predict(coded_lists(sun_from_angles([[12.3, -4.5]])))).round(3)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="coded-places",
        taxonomy="Coded",
        origin="ours",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOTS}),
    )

    #: A group's few spots may lie alike on the pixels, which wide ones hardly notice.
    phase_px: ClassVar[float] = 0.0002

    def search(self) -> Search:
        """Return the search for the highest peak of the correlation."""
        from algorithms.calibration.coded.identity_kernel import search_correlation  # noqa: PLC0415 - Numba, at first use

        return search_correlation

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Read the codes, then place apertures and fit the assembly by turns."""
        super().learn(features, sun, context)
        seen = self._read(features, self._places())
        self.offsets_ = np.zeros_like(self.offsets_)
        self.settle(_positions(features), seen.apertures, self._places(), sun)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of lists of spots (N, 3 K)."""
        return ForwardModel.answer(self, self._displaced(features), context)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the assembly's errors make, rad^2."""
        return ForwardModel.variance(self, self._displaced(features), context)

    def _displaced(self, features: Floats) -> Floats:
        seen = self._read(features, self._places())
        found = self.displacements(
            _positions(features), seen.apertures, self._places() - self.offsets_
        )
        return np.where(np.isnan(seen.displacement), np.nan, found)


def _positions(features: Floats) -> Floats:
    """Spots (N, K, 2) of lists (N, 3 K)."""
    return features.reshape(len(features), -1, SPOT_COLUMNS)[:, :, :2]
