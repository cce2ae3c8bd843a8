"""What an implementation says of itself: `About`, and what each stage of a chain adds to it."""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, get_args

from algorithms.context import CONTEXT
from algorithms.design import SensorGeometry, UnsuitableDesignError

Origin = Literal["survey", "ours"]

#: Of one implementation; of a chain of them, with " + " between.
_SLUG = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*( \+ [a-z0-9]+(-[a-z0-9]+)*)*")


class Observation(StrEnum):
    """What an extractor reads; the array shape of a batch of N."""

    FRAMES = "frames"  # (N, H, W) digital numbers or electrons
    PROFILES = "profiles"  # (N, W)
    CURRENTS = "currents"  # (N, K) currents, voltages or frequencies, one column a detector
    EVENTS = "events"  # (N, M, 3) x_px, y_px, t_us since reset, by time; NaN rows after the last


class FeatureKind(StrEnum):
    """What an extractor's columns mean, and so which models can read them."""

    SPOT = "spot"  # (x_px, y_px): one spot, detector coordinates
    SPOTS = "spots"  # (x_px, y_px, light) of each of many spots; light 0, and 0, 0, for none
    BALANCE = "balance"  # (s_a, s_b): x and y balances in [-1, 1]
    SIGNALS = "signals"  # one normalised signal a detector element


@dataclass(frozen=True, kw_only=True)
class About:
    """What an implementation says of itself: a class variable named ``about``.

    The catalogue lists it, the plan asks it what fits what, and results are kept under its name
    and version; a wrong word is refused where it is written.

    Parameters
    ----------
    name : str
        Unique slug of the implementation, such as ``"bctm"``: lower case, digits and hyphens.
    taxonomy : str
        Value of the survey's taxonomy, such as ``"BCTM"``; ``"None"`` where it has none.
    studies : tuple of str
        Keys of the case studies the implementation follows, such as ``"He2005"``.
    labels : tuple of str
        The survey's section, equation and algorithm labels, such as ``"fe:bctm"``.
    origin : {"ours", "survey"}
        Whether the method is one that the survey describes.
    version : int
        Raised by one when the numbers it returns change on purpose.
    needs : tuple of str
        Fields of `SensorGeometry` without which ``for_sensor`` cannot make it.

    Raises
    ------
    TypeError
        If a list of words is given as anything but a tuple.
    ValueError
        If a value is none of those said above; the message names it.

    Examples
    --------
    >>> About(name="Centroid 2", taxonomy="BCM")
    Traceback (most recent call last):
    ValueError: name must be words of a-z and 0-9 with hyphens; got 'Centroid 2'
    """

    name: str
    taxonomy: str
    studies: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    origin: Origin = "ours"
    version: int = 1
    needs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for words in ("studies", "labels", "needs"):
            if not isinstance(getattr(self, words), tuple):
                raise TypeError(f"{words} must be a tuple; got {getattr(self, words)!r}")
        if not _SLUG.fullmatch(self.name):
            raise ValueError(f"name must be words of a-z and 0-9 with hyphens; got {self.name!r}")
        if not self.taxonomy:
            raise ValueError(f"{self.name}: taxonomy must not be empty")
        if self.origin not in get_args(Origin):
            raise ValueError(f"{self.name}: origin must be survey or ours; got {self.origin!r}")
        if self.version < 1:
            raise ValueError(f"{self.name}: version must be at least 1; got {self.version!r}")
        fields = {field.name for field in dataclasses.fields(SensorGeometry)}
        if unknown := sorted(set(self.needs) - fields):
            raise ValueError(
                f"{self.name}: needs must be fields of SensorGeometry; got {', '.join(unknown)}"
            )


@dataclass(frozen=True, kw_only=True)
class AboutExtractor(About):
    """What an extractor says of itself.

    To what every implementation says, what it reads and what it gives.

    Parameters
    ----------
    name, taxonomy, studies, labels, origin, version, needs
        See `About`.
    observation : Observation
        What it reads.
    kind : FeatureKind
        What its columns mean.

    Examples
    --------
    >>> about = AboutExtractor(
    ...     name="bcm", taxonomy="BCM", observation=Observation.FRAMES, kind=FeatureKind.SPOT
    ... )
    >>> about.version, str(about.kind)
    (1, 'spot')
    """

    observation: Observation
    kind: FeatureKind


@dataclass(frozen=True, kw_only=True)
class _AboutFitted(About):
    """What calibrated stages say beyond `About`: the features and the context they read."""

    accepts: frozenset[FeatureKind]
    context: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.accepts:
            raise ValueError(f"{self.name}: accepts must name a kind of features; got none")
        if not isinstance(self.context, tuple):
            raise TypeError(f"context must be a tuple; got {self.context!r}")
        if unknown := sorted(set(self.context) - CONTEXT.keys()):
            raise ValueError(
                f"{self.name}: context must be columns of {', '.join(CONTEXT)}; "
                f"got {', '.join(unknown)}"
            )

    def require_kind(self, kind: FeatureKind) -> None:
        """Raise UnsuitableDesignError unless `kind` is one of those accepted."""
        if kind not in self.accepts:
            raise UnsuitableDesignError(
                f"{self.name} accepts {', '.join(sorted(self.accepts))} features; got {kind}"
            )


@dataclass(frozen=True, kw_only=True)
class AboutModel(_AboutFitted):
    """What a model says of itself.

    To what every implementation says, the features it reads and what else it must know.

    Parameters
    ----------
    name, taxonomy, studies, labels, origin, version, needs
        See `About`.
    accepts : frozenset of FeatureKind
        Kinds of features it reads. `needs` are those of all of them.
    context : tuple of str
        Columns of `algorithms.context.CONTEXT` it reads beside the features.

    Examples
    --------
    >>> about = AboutModel(name="spm", taxonomy="SPM", accepts=frozenset({FeatureKind.SPOT}))
    >>> about.require_kind(FeatureKind.SIGNALS)
    Traceback (most recent call last):
    algorithms.design.UnsuitableDesignError: spm accepts spot features; got signals
    """


@dataclass(frozen=True, kw_only=True)
class AboutCompensation(_AboutFitted):
    """What a compensation says of itself.

    A compensation gives features of the kind it was given, so that any model may follow.

    Parameters
    ----------
    name, taxonomy, studies, labels, origin, version, needs
        See `About`.
    accepts : frozenset of FeatureKind
        Kinds of features it corrects.
    context : tuple of str
        Columns of `algorithms.context.CONTEXT` it reads beside the features.
    ahead_of : tuple of str
        Names of the models, alone or behind other compensations, that it is planned and scored with
        (`algorithms.chain`); it may be put ahead of any other that reads its features.

    Examples
    --------
    >>> AboutCompensation(
    ...     name="drift",
    ...     taxonomy="SECM (Temperature)",
    ...     accepts=frozenset({FeatureKind.SIGNALS}),
    ...     context=("heat",),
    ... )  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: drift: context must be columns of time_s, temperature_K, ...; got heat
    """

    ahead_of: tuple[str, ...] = ()
