"""The contract every extractor and model keeps; `algorithms.pipeline` puts the two together.

Conventions: the Sun is a unit vector ``s`` from the sensor to the Sun, shape (N, 3), +z the
boresight. ``tan(alpha) = s_y/s_z``, ``tan(beta) = s_x/s_z``; a pinhole spot falls at
``X = h tan(beta)``, ``Y = h tan(alpha)``. Pixel centres are integers, order (x, y), x along
columns. Public angles are degrees. A row where nothing is found is NaN.
"""

from __future__ import annotations

import dataclasses
import re
from abc import abstractmethod
from dataclasses import dataclass
from enum import StrEnum
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Literal,
    Protocol,
    Self,
    cast,
    get_args,
    runtime_checkable,
)

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.measurement import Measurement, measured

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Floats = NDArray[np.float64]

Origin = Literal["survey", "ours"]

_SLUG = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


class Observation(StrEnum):
    """What an extractor reads; the array shape of a batch of N."""

    FRAMES = "frames"  # (N, H, W) digital numbers or electrons
    PROFILES = "profiles"  # (N, W)
    CURRENTS = "currents"  # (N, K) currents, voltages or frequencies, one column a detector
    EVENTS = "events"  # (N, M, 3) x_px, y_px, t_us since reset, by time; NaN rows after the last


class FeatureKind(StrEnum):
    """What an extractor's columns mean, and so which models can read them."""

    SPOT = "spot"  # (x_px, y_px): one spot, detector coordinates
    BALANCE = "balance"  # (s_a, s_b): x and y balances in [-1, 1]
    SIGNALS = "signals"  # one normalised signal a detector element


#: Names of a kind's columns, where they are the same for every sensor.
_COLUMNS = {FeatureKind.SPOT: ("x_px", "y_px"), FeatureKind.BALANCE: ("s_a", "s_b")}


class NotFittedError(ValueError, AttributeError):
    """A model was asked to predict before it was fitted."""


class UnusableDataError(ValueError):
    """Well-formed data that a method cannot work on: too few samples, or on one line.

    What a model's ``fit`` raises for a calibration that does not settle it: a result of method
    and data, as repeatable as a score. Any other error, a ValueError too, is a mistake: of the
    caller (a wrong shape) or of the implementation.
    """


class UnsuitableDesignError(ValueError):
    """A sensor's design that a method does not read; what ``for_sensor`` raises."""


@dataclass(frozen=True)
class SensorGeometry:
    """The sensor's nominal design: what its builder knows before any calibration.

    A field is None where the architecture has no such thing.

    Parameters
    ----------
    focal_length_mm : float, optional
        Distance h from the mask or lens to the detector.
    pixel_pitch_mm : float, optional
        Distance of two pixels.
    centre_px : tuple of two float, optional
        Where the boresight meets the detector, (x, y).
    aperture_width_mm : float, optional
        Diameter or side of the one aperture.
    aperture_shape : {"round", "square"}, optional
        Of the one aperture, or of all of them.
    face_normals : tuple of K vectors, optional
        Unit vectors in the sensor frame, one a detector element.
    half_fov_deg : float, optional
        Largest off-axis angle of the field of view.
    line_axes : tuple of {"x", "y"}, optional
        The detector axis along which each linear array (or code dial) lies, in the order of
        their columns in a profile; all arrays lie behind slits of the same layout.
    line_pixels : int, optional
        Pixels of each linear array.
    slits : tuple of (float, float, float), optional
        Position mm, slant deg and width mm of each. Its spot falls ``position + D_u + D_v
        tan(slant)`` from the array's middle, D the displacement (h tan(beta), h tan(alpha)), u
        the array's axis and v the other one.
    mask_thickness_mm : float, optional
        Of the mask.
    cover_glass : tuple of (float, float), optional
        Thickness mm and index of each plate.
    code_bits : int, optional
        Gray tracks of a code dial; four fine tracks follow them.
    code_cell_mm : float, optional
        Length of a Gray cell.
    fine_period_mm : float, optional
        Period of the fine tracks.
    apertures : tuple of (float, float, float), optional
        Place (x mm, y mm) over the detector's centre and width mm of each aperture of many.
    subfields : int, optional
        Coded groups of apertures an axis, in rows of groups.
    lens_distortion : tuple of two float, optional
        (k1, k2): a lens images the tangents t of a direction, r = abs(t), at ``focal_length_mm t
        (1 + k1 r^2 + k2 r^4)``.

    Examples
    --------
    >>> quadrants = SensorGeometry(focal_length_mm=2.0, aperture_width_mm=4.0)
    >>> quadrants.require("line_axes", by="pd")
    Traceback (most recent call last):
    algorithms.contract.UnsuitableDesignError: pd needs the sensor geometry's line_axes; got None
    """

    focal_length_mm: float | None = None
    pixel_pitch_mm: float | None = None
    centre_px: tuple[float, float] | None = None
    aperture_width_mm: float | None = None
    aperture_shape: Literal["round", "square"] | None = None
    face_normals: tuple[tuple[float, float, float], ...] | None = None
    half_fov_deg: float | None = None
    line_axes: tuple[Literal["x", "y"], ...] | None = None
    line_pixels: int | None = None
    slits: tuple[tuple[float, float, float], ...] | None = None
    mask_thickness_mm: float | None = None
    cover_glass: tuple[tuple[float, float], ...] | None = None
    code_bits: int | None = None
    code_cell_mm: float | None = None
    fine_period_mm: float | None = None
    apertures: tuple[tuple[float, float, float], ...] | None = None
    subfields: int | None = None
    lens_distortion: tuple[float, float] | None = None

    def require(self, *fields: str, by: str) -> None:
        """Raise UnsuitableDesignError naming the fields that `by` needs and that are None."""
        missing = [name for name in fields if getattr(self, name) is None]
        if missing:
            raise UnsuitableDesignError(
                f"{by} needs the sensor geometry's {', '.join(missing)}; got None"
            )


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
class AboutModel(About):
    """What a model says of itself.

    To what every implementation says, the features it reads.

    Parameters
    ----------
    name, taxonomy, studies, labels, origin, version, needs
        See `About`.
    accepts : frozenset of FeatureKind
        Kinds of features it reads. `needs` are those of all of them.

    Examples
    --------
    >>> about = AboutModel(name="spm", taxonomy="SPM", accepts=frozenset({FeatureKind.SPOT}))
    >>> about.require_kind(FeatureKind.SIGNALS)
    Traceback (most recent call last):
    algorithms.contract.UnsuitableDesignError: spm accepts spot features; got signals
    """

    accepts: frozenset[FeatureKind]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.accepts:
            raise ValueError(f"{self.name}: accepts must name a kind of features; got none")

    def require_kind(self, kind: FeatureKind) -> None:
        """Raise UnsuitableDesignError unless `kind` is one of those accepted."""
        if kind not in self.accepts:
            raise UnsuitableDesignError(
                f"{self.name} accepts {', '.join(sorted(self.accepts))} features; got {kind}"
            )


@runtime_checkable
class Extractor(Protocol):
    """Observations in, features out; a frozen dataclass whose fields are its parameters.

    An implementation names this class as its base and writes `about` and `extract`; the other
    members serve it as they stand unless its parameters, columns or covariance are its own.
    """

    about: ClassVar[AboutExtractor]

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the F output columns; by default those of the kind."""
        columns = _COLUMNS.get(self.about.kind)
        if columns is None:
            raise NotImplementedError(
                f"{self.about.name} must name its own columns: {self.about.kind} have no fixed ones"
            )
        return columns

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the extractor with the parameters this sensor's design asks for.

        By default those of the published method, whatever the sensor. UnsuitableDesignError where
        it does not read sensors of this design, or where a field it needs is None.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls()

    @abstractmethod
    def extract(self, observations: ArrayLike) -> Floats:
        """(N, F) float64; a NaN row where nothing was found. ValueError on wrong input."""
        ...

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Features as `extract`, their covariance and doubts; see `algorithms.measurement`.

        A single sample is a batch of one; `bad`, True for a bad pixel, has one sample's shape.
        """
        return measured(self.extract, self.about.observation, self.about.name, observations, bad)


@runtime_checkable
class Model(Protocol):
    """Features in, Sun unit vectors out. Dataclasses: init fields = parameters, fitted end in _.

    An implementation names this class as its base and writes `about`, `fit` and `predict`;
    `for_sensor` serves as it stands a model that learns all it knows from its calibration.
    """

    about: ClassVar[AboutModel]

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted model for this sensor's design and this kind of features.

        By default the published model, whatever the sensor. UnsuitableDesignError where `kind` is
        not accepted or a field it takes is None.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls()

    @abstractmethod
    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Learn from features (N, F) and unit vectors (N, 3); NaN feature rows are left out.

        UnusableDataError where they do not settle the model; ValueError on wrong input.
        """
        ...

    @abstractmethod
    def predict(self, features: ArrayLike) -> Floats:
        """(N, 3) unit vectors; NaN rows where undefined. NotFittedError before fit."""
        ...


def parameters(implementation: Extractor | Model) -> dict[str, Any]:
    """Return the constructor parameters of an implementation, by name.

    Parameters
    ----------
    implementation : Extractor or Model
        Fitted or not.

    Returns
    -------
    dict
        Values by name, in the constructor's order.

    Raises
    ------
    TypeError
        If it is not a dataclass.

    Examples
    --------
    >>> from algorithms.models.non_physical.linear import LinearFit
    >>> parameters(LinearFit(target="tangent"))
    {'target': 'tangent'}
    """
    # The protocols are structural: that an implementation is a dataclass, only running it shows.
    fields = dataclasses.fields(cast("DataclassInstance", implementation))
    return {field.name: getattr(implementation, field.name) for field in fields if field.init}
