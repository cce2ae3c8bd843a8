"""Coded masks read by the spacings of neighbouring spots, and by their sizes (Coded)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from algorithms.calibration.coded.mask import NEEDS, CodedMask, Search
from algorithms.contract import AboutModel, FeatureKind
from algorithms.documented import documented


@documented
@dataclass
class CodedSpacing(CodedMask):
    """Visible part of a coded mask by spacings of spots, then one direction from all spots.

    Spacings of neighbouring spots identify the visible sub-field; so do their sizes if the mask
    encodes by size. All spots that match there give one direction.

    Notes
    -----
    Implements: model:multiplex, model:code. The survey describes the masks, but no algorithm:
    groups of three whose distances are unique (Wei2013, Wei2014), distances and sizes (Wang2015),
    apertures placed obliquely without symmetry (Wei2017). Here a table holds the pairs of
    neighbouring apertures by their spacing (x, y), in cells of the tolerance; the rarest of the
    spacings seen name places of the mask, and the place with the fewest faults is looked at again.
    That place is compared with every other one that is nearly as likely, decided exactly, not
    among those tried: ``p = t(r) (100 A)^-left (0.9 0.01^dark + 0.1 0.2^dark)``, r what the n
    spots it explains are from their apertures less their mean, t the density of residuals of the
    design's deviation (a fifth of the tolerance) or, of one list in ten thousand, of one that the
    list alone tells; A the detector's area. It is kept if it is `odds` times as likely as any
    other. Then ``D = sum(p_i - a_i - o_i) / n`` over the n spots that agree is the least-squares
    displacement, and so direction, of all of them: parallel light moves every spot alike. Spots
    far from the median are left out. o_i are offsets of the built apertures, predicted from how
    spots of one frame lie to each other (best linear unbiased; no error of the turntable enters);
    focal length, centre, turns and tilts are fitted to D by least squares of the angles, through
    the cover glass.

    Failure: a NaN row for a NaN feature row, outside the cone of calibrated directions, beyond the
    field of view, where fewer than `agreeing` spots agree, and where another place explains the
    spots nearly as well (`read` says ``ambiguous``). fit raises UnusableDataError where the code is
    read in less than half of the samples, and below 4 samples; ValueError for a list with a gap.

    Cost: 6 to 40 us per sample, for a mask of a thousand apertures as for one of a hundred.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import coded_design, coded_lists, sun_grid
    >>> sun = sun_grid(range(-40, 41, 10))
    >>> model = CodedSpacing(**coded_design()).fit(coded_lists(sun), sun)
    >>> angles_from_sun(model.predict(coded_lists(sun_from_angles([[12.3, -4.5]])))).round(3)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="coded-spacing",
        taxonomy="Coded",
        studies=("Wei2013", "Wei2014", "Wang2015", "Wei2017"),
        labels=("model:multiplex", "model:code"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOTS}),
    )

    def search(self) -> Search:
        """Return the search among places that rare spacings name."""
        from algorithms.calibration.coded.identity_kernel import search_spacings  # noqa: PLC0415 - Numba, at first use

        return search_spacings
