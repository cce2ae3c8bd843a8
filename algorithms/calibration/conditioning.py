"""How badly samples may settle a fit before it is refused."""

from __future__ import annotations

WORST_CONDITION = 1e10
"""Largest condition of a fit's equations, their columns brought to one scale: six digits are left
of sixteen, so that another order of sums, as on another processor, does not show in a score."""

WORST_SOLUTION = 1e5
"""The same of a nonlinear fit, at its solution: beyond, numbers run off along a valley and stop
where rounding stops them. Samples over a field of view leave less than some hundred."""
