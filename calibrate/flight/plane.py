"""Steps from two features to a direction: the smallest closed form or spline that is as good."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from algorithms.angles import separation_deg
from algorithms.calibration.hull import Hull
from algorithms.contract import Floats
from calibrate.flight.program import NoCodeError, Step, run
from calibrate.flight.runtime import chebyshev
from calibrate.selection import unbounded

#: Largest difference from the model that is aimed at, over the model's error.
AIM = 0.01
_DEGREES, _AXES, _WARM = range(1, 16), range(1, 31), range(1, 4)
_MOST_OF_RATIO = 4
_SIZES = (9, 13, 17, 25, 33, 49, 65)
#: Places between samples at which forms are fitted, and as many others at which they are judged.
_PLACES = 3000
#: Margin of code for a model without bounds, over half the field's width.
_BEYOND = 0.1
#: Degrees of what compensations do to features.
_OF_STAGES = range(1, 16)


@dataclass(frozen=True)
class _Samples:
    """Places in the field, temperatures, and what the model answers there."""

    features: Floats
    kelvin: Floats | None
    sun: Floats


def plane_steps(
    model: Any, features: Floats, context: Mapping[str, Floats], error_deg: float
) -> tuple[list[Step], str]:
    """Return the steps from two features to a direction, and a word for them.

    Features (N, 2) are those of the calibration; the steps may add a hundredth of the model's RMS
    error. NoCodeError if the chain answers nowhere inside its hull, or no polynomial follows its
    compensations.
    """
    stages, last = tuple(getattr(model, "compensations", ())), getattr(model, "model", model)
    steps: list[Step] = []
    inner = features
    for stage in stages:
        inner = stage.transform(inner, context)
    if stages:
        steps.append(_warp(stages, features, context, error_deg))
    # a drawing holds everywhere; code stands for it somewhat beyond what was calibrated
    bounded = len(last.hull_.facets) > 0
    region = last.hull_ if bounded else Hull.around(inner, "flight code", _BEYOND)
    steps.append(_hull(region))
    kelvin = context.get("temperature_K") if "temperature_K" in last.about.context else None
    open_last = unbounded(last)

    def sampled(places: Floats, at: Floats | None) -> _Samples:
        columns = {} if at is None else {"temperature_K": at}
        sun = open_last.predict(places, columns)
        known = np.isfinite(sun).all(axis=1)
        if known.sum() < terms_of(1, 0):
            raise NoCodeError("the chain answers nowhere inside its hull")
        return _Samples(places[known], None if at is None else at[known], sun[known])

    fitted = sampled(*_places(region, inner, kelvin, 0))
    judged = sampled(*_places(region, inner, kelvin, _PLACES))
    families = _families(fitted, partial(_spline, sampled, region, inner))
    made, words = _smallest(families, judged, error_deg)
    return [*steps, *made], words


@dataclass(frozen=True)
class _Family:
    """Forms of one kind, the fewest constants first."""

    words: str  # with ``{}`` for the order
    sizes: tuple[int, ...]  # constants of each order
    orders: tuple[tuple[int, ...], ...]  # what `make` is called with
    make: Callable[..., list[Step]]  # gives the steps of an order
    rising: bool = False  # from the least order on: the most takes long, or errs more


@dataclass(frozen=True)
class _Tried:
    """Steps with what they add at places that they were not fitted to, degrees."""

    size: int
    words: str
    steps: list[Step]
    rms_deg: float
    largest_deg: float


def _smallest(
    families: Sequence[_Family], judged: _Samples, error_deg: float
) -> tuple[list[Step], str]:
    """Return the smallest form that reaches the aim, else that which adds least."""
    good: _Tried | None = None
    other: list[_Tried] = []
    for family in families:
        most = len(family.sizes) if good is None else bisect_left(family.sizes, good.size)
        best = _best_of(family, most, judged, AIM * error_deg) if most else None
        if best is None:
            continue
        if best.largest_deg <= AIM * error_deg:
            good = best
        else:
            other.append(best)
    if good is None:
        good = min(other, key=lambda one: max(one.rms_deg, 0.5 * AIM * error_deg))
    return good.steps, good.words


def _best_of(family: _Family, most: int, judged: _Samples, aim_deg: float) -> _Tried:
    """Return the least of a family's first orders that reaches an aim, else the last of them."""
    known: dict[int, _Tried] = {}

    def reaches(at: int) -> bool:
        known[at] = _tried(family, at, judged)
        return known[at].largest_deg <= aim_deg

    if family.rising:
        found = next((at for at in range(most) if reaches(at)), most - 1)
    elif not reaches(most - 1):
        found = most - 1
    else:  # errors fall with the order
        found = bisect_left(range(most - 1), True, key=reaches)
    return known[found]


def _tried(family: _Family, at: int, judged: _Samples) -> _Tried:
    steps = family.make(*family.orders[at])
    _, sun, _ = run(tuple(steps), judged.features, judged.kelvin)
    off = np.nan_to_num(separation_deg(sun, judged.sun), nan=180.0)
    return _Tried(
        family.sizes[at], family.words.format(family.orders[at][0]), steps,
        float(np.sqrt(np.mean(off**2))), float(off.max()),
    )  # fmt: skip


def _families(fitted: _Samples, spline_of: Callable[[str, int], Step]) -> list[_Family]:
    """Return every family of forms, those of few constants first."""
    features, kelvin, sun = fitted.features, fitted.kelvin, fitted.sun
    tangents = sun[:, :2] / sun[:, 2:]
    targets = {"tangents": tangents, "angles": np.arctan(tangents)}
    warms = (0,) if kelvin is None else _WARM
    most = len(features) // 2

    def ratio(degree: int, warm: int) -> list[Step]:
        return [fitted_ratio(features, kelvin, sun, degree, warm), _direction("ratio")]

    def surface(name: str, degree: int, warm: int) -> list[Step]:
        step = fitted_polynomial(features, kelvin, targets[name], degree, warm)
        return [step, _direction(name)]

    def axes(name: str, degree: int) -> list[Step]:
        return [fitted_axes(features, targets[name], degree), _direction(name)]

    def spline(name: str, size: int) -> list[Step]:
        return [spline_of(name, size), _direction(name)]

    def family(words: str, made: Mapping[Any, int], make: Any, *, rising: bool = False) -> _Family:
        kept = sorted((size, order) for order, size in made.items() if size <= most)
        sizes, orders = zip(*kept, strict=True)
        return _Family(words, sizes, orders, make, rising)

    mixed = {(n, warm): terms_of(n, warm) for n in _DEGREES for warm in warms}
    ratios = {order: 3 * size for order, size in mixed.items() if order[0] <= _MOST_OF_RATIO}
    # of a ratio that a lower degree gives exactly, a higher one may have a pole in the field
    found = [family("a ratio of polynomials of degree {}", ratios, ratio, rising=True)]
    surfaces = {order: 2 * size for order, size in mixed.items()}
    if kelvin is None:
        on_axes = {(n,): 2 * (n + 1) for n in _AXES}
        found += [
            family("a polynomial of degree {} an axis", on_axes, partial(axes, name))
            for name in targets
        ]
    found += [
        family("polynomials of degree {}", surfaces, partial(surface, name)) for name in targets
    ]
    if kelvin is None:
        nodes = {(n,): 2 * n * n for n in _SIZES}
        found += [
            _Family("a cubic spline of {0} by {0} nodes", tuple(nodes.values()), tuple(nodes),
                    partial(spline, name), rising=True)
            for name in targets
        ]  # fmt: skip
    return found


def _spline(
    sampled: Callable[[Floats, Floats | None], _Samples],
    region: Hull,
    inner: Floats,
    name: str,
    size: int,
) -> Step:
    """Return a spline fitted to samples a third of its cells apart."""
    low, high = inner.min(axis=0) - region.margin, inner.max(axis=0) + region.margin
    lines = [np.linspace(low[k], high[k], 3 * size + 1) for k in (0, 1)]
    grid = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2)
    near = sampled(grid[region.outside(grid) <= region.margin], None)
    tangents = near.sun[:, :2] / near.sun[:, 2:]
    wanted = tangents if name == "tangents" else np.arctan(tangents)
    return fitted_spline(near.features, wanted, size)


def _direction(name: str) -> Step:
    operations = {"tangents": 12, "angles": 12, "ratio": 12}
    calls = {"tangents": 3, "angles": 5, "ratio": 1}
    return Step(name, {}, operations[name], calls[name])


def _hull(region: Hull) -> Step:
    sides = len(region.facets)
    return Step(
        "hull",
        {
            "sides": sides,
            "normal": region.facets[:, :2],
            "offset": region.facets[:, 2],
            "margin": float(region.margin),
        },
        5 * sides,
    )


def _warp(
    stages: tuple[Any, ...], features: Floats, context: Mapping[str, Floats], error_deg: float
) -> Step:
    """Return the polynomials that follow what compensations do to two features."""
    warm = any("temperature_K" in stage.about.context for stage in stages)
    kelvin = context["temperature_K"] if warm else None
    region = Hull.around(features, "flight code")

    def applied(places: Floats, at: Floats | None) -> tuple[Floats, Floats | None, Floats]:
        columns = {} if at is None else {"temperature_K": at}
        moved = places
        for stage in stages:
            moved = stage.transform(moved, columns)
        known = np.isfinite(moved).all(axis=1)
        return places[known], None if at is None else at[known], moved[known]

    fitted = applied(*_places(region, features, kelvin, 0))
    judged = applied(*_places(region, features, kelvin, _PLACES))
    # a degree is no more than this much of the features' own range
    close = 0.1 * AIM * np.radians(error_deg) * float(np.ptp(fitted[2], axis=0).min())
    best: tuple[float, Step] | None = None
    for degree in _OF_STAGES:
        for powers in (0,) if kelvin is None else _WARM:
            if 2 * terms_of(degree, powers) > len(fitted[0]):
                continue
            step = fitted_polynomial(*fitted, degree, powers)
            found, _, _ = run((step,), judged[0], judged[1])
            off = float(np.abs(found - judged[2]).max())
            if off <= close:
                return step
            if best is None or off < 0.99 * best[0]:
                best = off, step
    assert best is not None  # noqa: S101 - there are always degrees
    return best[1]


def _places(
    region: Hull, features: Floats, kelvin: Floats | None, start: int
) -> tuple[Floats, Floats | None]:
    """Return places inside a region, the samples among the first, and temperatures."""
    low, high = features.min(axis=0) - region.margin, features.max(axis=0) + region.margin
    turns = np.arange(start, start + 4 * _PLACES) + 1.0
    # Roberts's sequence fills squares and cubes evenly
    even = np.column_stack(
        [(turns * step) % 1.0 for step in (0.819172513, 0.671043607, 0.549700478)]
    )
    drawn = low + (high - low) * even[:, :2]
    inside = np.flatnonzero(region.outside(drawn) <= region.margin)[:_PLACES]
    places = drawn[inside]
    at = None
    if kelvin is not None:
        coldest, warmest = float(kelvin.min()), float(kelvin.max())
        at = coldest + (warmest - coldest) * even[inside, 2]
    if start:
        return places, at
    edge = features[:: max(len(features) // _PLACES, 1)]
    step = max(len(features) // _PLACES, 1)
    return np.vstack([places, edge]), None if at is None else np.concatenate(
        [at, np.asarray(kelvin)[::step]]
    )


def scaling(features: Floats, kelvin: Floats | None) -> tuple[Floats, Floats]:
    """Return middle and half range (3,) of two features and the temperature."""
    warm = np.zeros(len(features)) if kelvin is None else kelvin
    columns = np.column_stack([features[:, :2], warm])
    low, high = columns.min(axis=0), columns.max(axis=0)
    half = (high - low) / 2.0
    return (low + high) / 2.0, np.where(half > 0, half, 1.0)


def terms_of(degree: int, warm: int) -> int:
    """Count the terms of a polynomial of a total degree, times powers of the temperature."""
    return (degree + 1) * (degree + 2) // 2 * (warm + 1)


def design_of(scaled: Floats, degree: int, warm: int) -> Floats:
    """Return the terms (N, terms) in the order in which `runtime.polynomial` reads them."""
    x, y, t = scaled.T
    tx, ty, tt = chebyshev(x, degree), chebyshev(y, degree), chebyshev(t, warm)
    return np.column_stack(
        [
            tt[k] * ty[j] * tx[i]
            for k in range(warm + 1)
            for j in range(degree + 1)
            for i in range(degree + 1 - j)
        ]
    )


def least_squares(design: Floats, wanted: Floats) -> Floats:
    """Return the coefficients (terms, P) of a design that fit best."""
    from scipy.linalg import lstsq  # noqa: PLC0415 - SciPy, at the first use

    found: Any = lstsq(design, wanted, cond=1e-13, lapack_driver="gelsy", check_finite=False)[0]
    return np.asarray(found)


def polynomial_step(
    scale: tuple[Floats, Floats], degree: int, warm: int, coefficients: Floats
) -> Step:
    """Return the step of polynomials with coefficients (P, terms)."""
    middle, half = scale
    outputs, terms = len(coefficients), terms_of(degree, 0)
    return Step(
        "polynomial",
        {
            "middle": middle, "half": half, "degree": degree, "warm": warm, "outputs": outputs,
            "coefficients": coefficients.reshape(-1),
        },
        outputs * (warm + 1) * (2 * terms + 3 * (degree + 1)) + 6 * degree + 3 * warm + 6,
    )  # fmt: skip


def fitted_polynomial(
    samples: Floats, kelvin: Floats | None, wanted: Floats, degree: int, warm: int
) -> Step:
    """Return polynomials of features (N, 2) that fit values (N, P) best."""
    scale = scaling(samples, kelvin)
    design = design_of(_scaled(samples, kelvin, scale), degree, warm)
    return polynomial_step(scale, degree, warm, least_squares(design, wanted).T)


def fitted_ratio(
    samples: Floats, kelvin: Floats | None, sun: Floats, degree: int, warm: int
) -> Step:
    """Return three polynomials of features (N, 2) whose vector points along directions (N, 3)."""
    scale = scaling(samples, kelvin)
    design = design_of(_scaled(samples, kelvin, scale), degree, warm)
    x, y, z = (design * component[:, None] for component in sun.T)
    nothing = np.zeros_like(x)
    equations = np.vstack([np.hstack([z, nothing, -x]), np.hstack([nothing, z, -y])])
    # the equations' null vector, or what is nearest to one
    coefficients = np.linalg.svd(np.linalg.qr(equations, mode="r"))[2][-1].reshape(3, -1)
    front = float(np.median(design @ coefficients[2]))
    coefficients = coefficients / (front or 1.0)
    return polynomial_step(scale, degree, warm, coefficients)


def fitted_axes(samples: Floats, wanted: Floats, degree: int) -> Step:
    """Return a polynomial of each feature (N, 2) that fits its own value (N, 2) best."""
    middle, half = scaling(samples, None)
    columns = (samples - middle[:2]) / half[:2]
    coefficients = np.stack(
        [
            least_squares(np.column_stack(chebyshev(columns[:, k], degree)), wanted[:, k])
            for k in range(2)
        ]
    )
    return Step(
        "axis_polynomials",
        {"middle": middle[:2], "half": half[:2], "degree": degree, "coefficients": coefficients},
        2 * (2 + 3 * degree + 2 * (degree + 1)),
    )


def fitted_spline(samples: Floats, wanted: Floats, size: int) -> Step:
    """Return two cubic splines over size x size nodes that fit values (N, 2) best."""
    from scipy.sparse import csr_array, diags_array, eye_array, kron, vstack  # noqa: PLC0415
    from scipy.sparse.linalg import splu  # noqa: PLC0415 - SciPy, at the first use

    low, high = samples.min(axis=0), samples.max(axis=0)
    step = (high - low) / (size - 3)
    first = low - step  # one node more on each side, which the cubic reads
    cells = (samples - first) / step
    corner = np.clip(np.floor(cells).astype(np.int64), 1, size - 3)
    t = cells - corner
    weights = np.stack(
        [
            (1.0 - t) ** 3 / 6.0,
            t * t * (0.5 * t - 1.0) + 2.0 / 3.0,
            ((-0.5 * t + 0.5) * t + 0.5) * t + 1.0 / 6.0,
            t**3 / 6.0,
        ]
    )
    rows = np.arange(len(samples))
    data, at = [], []
    for j in range(4):
        for i in range(4):
            data.append(weights[j, :, 1] * weights[i, :, 0])
            at.append((corner[:, 1] + j - 1) * size + corner[:, 0] + i - 1)
    design = csr_array(
        (np.concatenate(data), (np.tile(rows, 16), np.concatenate(at))),
        shape=(len(samples), size * size),
    )
    bend = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(size - 2, size))
    same = eye_array(size)
    # nodes that no sample reads go on as straight as those beside them
    rough = vstack([kron(bend, same), kron(same, bend)])
    normal = design.T @ design + _SMOOTH * (rough.T @ rough)
    nodes = splu(normal.tocsc()).solve(design.T @ wanted)
    return Step(
        "spline",
        {
            "first": first, "per_step": 1.0 / step, "columns": size, "lines": size,
            "nodes": nodes.reshape(size, size, 2),
        },
        4 + 6 + 2 * 24 + 16 * 5,
    )  # fmt: skip


#: Weight of squared second differences of nodes against squared errors of samples.
_SMOOTH = 1e-9


def _scaled(samples: Floats, kelvin: Floats | None, scale: tuple[Floats, Floats]) -> Floats:
    warm = np.zeros(len(samples)) if kelvin is None else kelvin
    return np.asarray((np.column_stack([samples[:, :2], warm]) - scale[0]) / scale[1])
