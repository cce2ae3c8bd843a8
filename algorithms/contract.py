"""The contract every extractor and model keeps, and the pipeline the two make.

Conventions: the Sun is a unit vector ``s`` from the sensor to the Sun, shape (N, 3), +z the
boresight. ``tan(alpha) = s_y/s_z``, ``tan(beta) = s_x/s_z``; a pinhole spot falls at
``X = h tan(beta)``, ``Y = h tan(alpha)``. Pixel centres are integers, order (x, y), x along
columns. Public angles are degrees. A row where nothing is found is NaN.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, Self, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Floats = NDArray[np.float64]

Origin = Literal["survey", "ours"]


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

    A field is None where the architecture has no such thing. ``face_normals`` holds K unit
    vectors in the sensor frame, one a detector element.

    Linear arrays: ``line_axes`` names the detector axis along which each of them lies, in the
    order of their ``line_pixels`` columns in a profile; all lie behind slits of the same layout.
    A row of ``slits`` is (position mm, slant deg, width mm): its spot falls ``position + D_u +
    D_v tan(slant)`` from the array's middle, D the displacement (h tan(beta), h tan(alpha)), u
    the array's axis and v the other one. ``cover_glass`` holds (thickness mm, index) a plate.

    Code dials: a row of ``code_bits`` Gray tracks with cells of ``code_cell_mm`` and four fine
    tracks of ``fine_period_mm`` on each of ``line_axes``.

    Masks of many apertures: a row of ``apertures`` is (x mm, y mm, width mm), the centre over the
    detector's centre; ``subfields`` counts the coded groups an axis, in rows of groups.

    Lenses: ``lens_distortion`` (k1, k2) images the tangents t of a direction, r = |t|, at
    ``focal_length_mm t (1 + k1 r^2 + k2 r^4)``.
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


@runtime_checkable
class Extractor(Protocol):
    """Observations in, features out; a frozen dataclass whose fields are its parameters."""

    name: ClassVar[str]  # unique slug of the implementation, e.g. "bctm"
    taxonomy: ClassVar[str]  # value of the survey's taxonomy, e.g. "BCTM"
    studies: ClassVar[tuple[str, ...]]  # case studies the implementation follows
    labels: ClassVar[tuple[str, ...]]  # the survey's section, equation and algorithm labels
    origin: ClassVar[Origin]
    version: ClassVar[int]  # raised when the numbers it returns change on purpose
    observation: ClassVar[Observation]
    kind: ClassVar[FeatureKind]
    needs: ClassVar[tuple[str, ...]]  # fields of SensorGeometry read by for_sensor

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the F output columns."""
        ...

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the extractor with the parameters this sensor's design asks for.

        UnsuitableDesignError where it does not read sensors of this design.
        """
        ...

    def extract(self, observations: ArrayLike) -> Floats:
        """(N, F) float64; a NaN row where nothing was found. ValueError on wrong input."""
        ...


@runtime_checkable
class Model(Protocol):
    """Features in, Sun unit vectors out. Dataclasses: init fields = parameters, fitted end in _."""

    name: ClassVar[str]
    taxonomy: ClassVar[str]
    studies: ClassVar[tuple[str, ...]]
    labels: ClassVar[tuple[str, ...]]
    origin: ClassVar[Origin]
    version: ClassVar[int]
    accepts: ClassVar[frozenset[FeatureKind]]
    needs: ClassVar[tuple[str, ...]]  # fields for_sensor takes whatever the kind of features

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted model for this sensor's design and this kind of features.

        UnsuitableDesignError where `kind` is not accepted or a field it takes is None.
        """
        ...

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Learn from features (N, F) and unit vectors (N, 3); NaN feature rows are left out.

        UnusableDataError where they do not settle the model; ValueError on wrong input.
        """
        ...

    def predict(self, features: ArrayLike) -> Floats:
        """(N, 3) unit vectors; NaN rows where undefined. NotFittedError before fit."""
        ...


def parameters(implementation: Extractor | Model) -> dict[str, Any]:
    """Return the constructor parameters of an implementation, by name.

    TypeError where it is not a dataclass.
    """
    # The protocols are structural: that an implementation is a dataclass, only running it shows.
    fields = dataclasses.fields(cast("DataclassInstance", implementation))
    return {field.name: getattr(implementation, field.name) for field in fields if field.init}


@dataclass
class Pipeline:
    """An extractor and a model: what a study resolves to, and what is scored.

    `origin_px` (N, 2) is the detector coordinate of each window's first pixel; it is added to
    spot features so that windows of a large detector score in detector coordinates.
    """

    extractor: Extractor
    model: Model

    def __post_init__(self) -> None:
        if self.extractor.kind not in self.model.accepts:
            raise ValueError(
                f"model {self.model.name} accepts {sorted(self.model.accepts)} features; "
                f"extractor {self.extractor.name} gives {self.extractor.kind}"
            )

    @classmethod
    def for_sensor(
        cls, extractor: type[Extractor], model: type[Model], geometry: SensorGeometry
    ) -> Self:
        """Both parts with the parameters this sensor's design asks for."""
        return cls(extractor.for_sensor(geometry), model.for_sensor(geometry, extractor.kind))

    def features(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Features (N, F) in detector coordinates."""
        return in_detector_coordinates(
            self.extractor.extract(observations), self.extractor.kind, origin_px
        )

    def fit(
        self, observations: ArrayLike, sun: ArrayLike, origin_px: ArrayLike | None = None
    ) -> Self:
        """Fit the model on the extracted features; returns self."""
        self.model.fit(self.features(observations, origin_px), sun)
        return self

    def predict(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Sun unit vectors (N, 3); NaN rows where undefined."""
        return self.model.predict(self.features(observations, origin_px))


def in_detector_coordinates(
    features: Floats, kind: FeatureKind, origin_px: ArrayLike | None
) -> Floats:
    """Spot features (N, 2) moved by their windows' origins (N, 2); other kinds unchanged."""
    if origin_px is None or kind is not FeatureKind.SPOT:
        return features
    origin = np.asarray(origin_px, dtype=np.float64)
    if origin.shape != features.shape:
        raise ValueError(f"origin_px must have shape {features.shape}; got {origin.shape}")
    return features + origin
