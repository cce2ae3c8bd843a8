"""A docstring completed: what a class does not describe comes from its bases and the glossary."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.documented import documented


@dataclass
class Base:
    """A base.

    Parameters
    ----------
    order : int
        Of the base.
    extrapolation : float
        How far.

    Attributes
    ----------
    hull_ : Hull
        Where answers are given.

    Notes
    -----
    Shapes: of the base.

    Failure: of the base.
    """

    order: int
    extrapolation: float = field(default=0.0, kw_only=True)
    hull_: object = field(init=False)


def made(studies: tuple[str, ...], labels: tuple[str, ...]) -> type:
    @documented
    @dataclass
    class Made(Base):
        """Do one thing.

        Parameters
        ----------
        order : int
            Of its own.

        Notes
        -----
        Implements: one equation.

        Failure: of its own.

        Examples
        --------
        >>> 1 + 1
        2
        """

        about: ClassVar = AboutModel(
            name="made",
            taxonomy="None",
            studies=studies,
            labels=labels,
            accepts=frozenset({FeatureKind.SPOT}),
        )
        unit_mm: float = 1.0

    return Made


EXPECTED = """\
Do one thing.

Parameters
----------
order : int
    Of its own.
unit_mm : float
    Displacement of the spot per unit of the feature, positive: the pixel pitch for spots, half the
    aperture's width for balances.
extrapolation : float
    How far.

Attributes
----------
hull_ : Hull
    Where answers are given.

Raises
------
ValueError
    If a parameter is not as said above; the message names it.

Notes
-----
Implements: one equation.

Shapes: of the base.

Failure: of its own.

References
----------
He2005; survey model:spm.

Examples
--------
>>> 1 + 1
2
"""


def test_every_section_is_completed_in_the_order_of_the_signature() -> None:
    assert made(("He2005",), ("model:spm",)).__doc__ == EXPECTED
