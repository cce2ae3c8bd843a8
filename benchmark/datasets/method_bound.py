"""The bound that holds for a method by what it reads: samples before, other instruments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from algorithms.contract import Floats

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.metrics.bounds import Bound


def method_bound_deg(
    preset: Preset,
    condition: str,
    context: frozenset[str],
    bound: Bound,
    *,
    unit_known: bool = True,
) -> Floats | None:
    """Return the bound (N,) in degrees of a method that reads more than one sample's signal.

    None where the single samples' bound holds: of methods that read nothing but readings apart.
    """
    posterior = getattr(preset, "posterior_bound_deg", None)
    if posterior is None:
        return None
    found: Floats | None = posterior(condition, context, bound, unit_known=unit_known)
    return found
