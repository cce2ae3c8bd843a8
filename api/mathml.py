"""Equations as MathML, which browsers draw without a script and without a network."""

from __future__ import annotations

import re

from latex2mathml.converter import convert

#: What the converter does not know, in words that it does.
_UNKNOWN_TEX = {r"\arg": r"\operatorname{arg}"}


def mathml(tex: str, *, block: bool = False) -> str:
    """Write an equation as MathML.

    Parameters
    ----------
    tex : LaTeX
    block : whether it stands on lines of its own
    """
    for unknown, known in _UNKNOWN_TEX.items():
        tex = re.sub(re.escape(unknown) + r"(?![a-zA-Z])", known.replace("\\", r"\\"), tex)
    return convert(tex, display="block" if block else "inline")
