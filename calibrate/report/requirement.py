"""Requirements on the error of a calibration, and whether they are met."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats, UnusableDataError
from calibrate.places import hull_of_poses
from calibrate.report.errors import THREE_SIGMA, Errors, fewest_for, field_of, level, ray

_FORM = re.compile(
    r"(?P<limit>\d+(\.\d*)?|\.\d+) *(?P<unit>deg|arcmin|arcsec|mrad) *@ *"
    r"(?P<level>[123] *sigma|rms|(?P<percent>\d+(\.\d+)?) *%)"
    r"( *, *(?P<half>\d+(\.\d*)?) *deg)?"
)
_UNITS = {"deg": 1.0, "arcmin": 1 / 60, "arcsec": 1 / 3600, "mrad": np.degrees(1e-3)}
_SIGMAS = {"1": 0.6827, "2": 0.9545, "3": THREE_SIGMA}


class RequirementError(ValueError):
    """A requirement that cannot be read: what was expected and what came."""


@dataclass(frozen=True)
class Requirement:
    """A largest error of a share of directions."""

    text: str  # as it was stated
    limit_deg: float
    share: float | None  # of directions within the limit; None for the RMS
    half_angle_deg: float | None  # off-axis angle up to which it holds; None for all

    @property
    def words(self) -> str:
        """The requirement in a sentence."""
        what = "RMS error" if self.share is None else f"error of {100 * self.share:.4g} % of poses"
        where = (
            "all poses"
            if self.half_angle_deg is None
            else f"0 to {self.half_angle_deg:g} deg off axis"
        )
        return f"{what} at most {self.limit_deg:.4g} deg, {where}"


@dataclass(frozen=True)
class Judged:
    """Whether a requirement is met.

    Not shown where poses are too few or do not reach far enough.
    """

    requirement: Requirement
    word: str  # met, not met or not shown
    found_deg: float  # error at the level asked; NaN where not known
    samples: int  # poses left out that tell it
    reason: str = ""  # empty where `found_deg` says it all

    @property
    def margin_deg(self) -> float:
        """Limit less error; negative where it is not met."""
        return self.requirement.limit_deg - self.found_deg

    @property
    def sentence(self) -> str:
        """The error found and its margin, or why it is not known."""
        said = []
        if np.isfinite(self.found_deg):
            limit = self.requirement.limit_deg
            said.append(
                f"{self.found_deg:.3g} of {limit:.3g} deg on {self.samples} poses left out, margin "
                f"{self.margin_deg:.2g} deg ({100 * self.margin_deg / limit:.0f} %)"
            )
        return "; ".join([*said, self.reason] if self.reason else said)


def requirement(text: str) -> Requirement:
    """Return a requirement such as ``0.1deg@3sigma,60deg``, ``0.05deg@95%`` or ``3arcmin@rms``.

    RequirementError if it is none.
    """
    found = _FORM.fullmatch(text.strip())
    if found is None:
        raise RequirementError(
            "expected a limit, a level (1sigma, 2sigma, 3sigma, 95%, rms) and, if it is not for "
            f"all poses, the half angle, such as 0.1deg@3sigma,60deg; got {text[:60]!r}"
        )
    limit = float(found["limit"]) * _UNITS[found["unit"]]
    share = None
    if found["percent"]:
        share = float(found["percent"]) / 100.0
    elif found["level"] != "rms":
        share = _SIGMAS[found["level"][0]]
    half = float(found["half"]) if found["half"] else None
    if not limit > 0 or (share is not None and not 0 < share < 1):
        raise RequirementError(
            f"expected a limit above 0 and a share between 0 and 100 %; got {text[:60]!r}"
        )
    if half is not None and not 0 < half <= 180:
        raise RequirementError(f"expected a half angle above 0, at most 180 deg; got {half:g} deg")
    return Requirement(text.strip(), limit, share, half)


def judged(asked: Requirement, sun: Floats, errors: Errors) -> Judged:
    """Return whether a calibration by poses (M, 3) meets a requirement on those left out.

    A pose that the fitted model does not answer counts as an error above the limit.
    """
    half = 180.0 if asked.half_angle_deg is None else asked.half_angle_deg
    within = errors.off_axis_deg <= half + 1e-9
    size = errors.errors_deg[within & errors.known]
    unanswered = int((~np.isfinite(errors.sigma_deg).all(axis=1) & within & ~errors.known).sum())
    size = np.concatenate([size, np.full(unanswered, np.inf)])
    if not len(size):
        return Judged(asked, "not shown", np.nan, 0, f"no pose within {half:g} deg off axis")
    achieved = _achieved(size, asked.share)
    if not np.isfinite(achieved):
        if unanswered and len(size) >= fewest_for(asked.share or 0.5):
            reason = f"the model does not answer {unanswered} of {len(size)} poses"
            return Judged(asked, "not met", np.nan, len(size), reason)
        wanted = fewest_for(asked.share or 0.5)
        reason = (
            f"it takes {wanted} poses left out, there are {len(size)}; their largest error is "
            f"{size[np.isfinite(size)].max(initial=0.0):.3g} deg"
        )
        return Judged(asked, "not shown", np.nan, len(size), reason)
    if achieved > asked.limit_deg:
        return Judged(asked, "not met", achieved, len(size))
    short = None if asked.half_angle_deg is None else _short_of(half, sun)
    if short is not None:
        reason = f"poses do not reach {half:g} deg off axis at azimuth {short:.0f} deg"
        return Judged(asked, "not shown", achieved, len(size), reason)
    return Judged(asked, "met", achieved, len(size))


def _achieved(size: Floats, share: float | None) -> float:
    if share is None:
        return float(np.sqrt(np.mean(size**2)))
    return level(size, share)


def _short_of(half: float, sun: Floats) -> float | None:
    """Return an azimuth at which poses end more than a step before an off-axis angle."""
    try:
        hull = hull_of_poses(sun)
    except UnusableDataError:  # along one axis, where a step is a hundredth of the sweep
        ends = field_of(sun)
        short = [] if ends is None else [at for at, reach in ends.reach if 1.01 * reach < half]
        return 0.0 if ends is None else next(iter(short), None)
    if not len(hull.facets):
        return None
    azimuths = np.arange(0.0, 360.0, 5.0)
    past = hull.outside(ray(azimuths, half)) - 2.0 * hull.margin
    return float(azimuths[np.argmax(past)]) if past.max() > 0 else None
