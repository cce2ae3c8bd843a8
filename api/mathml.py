"""Equations as MathML, which browsers draw without a script and without a network."""

from __future__ import annotations

import re
from html import unescape

from latex2mathml.converter import convert

#: What the converter does not know, in words that it does.
_UNKNOWN_TEX = {r"\arg": r"\operatorname{arg}"}
#: Of a function's name with a digit in it the converter makes letters to be multiplied.
_NUMBERED = re.compile(r"\\operatorname\{(\w*\d\w*)\}")
#: A variable: browsers would write it with the letters that only fonts for mathematics have, and
#: where there is none take them from any font. Styles write it in italics instead.
_VARIABLE = re.compile(r"<mi>(&#x[0-9A-F]+;|.)</mi>")
_LETTERS = range(0x250)  # Latin; and Greek
_GREEK = range(0x370, 0x400)


def mathml(tex: str, *, block: bool = False) -> str:
    """Write an equation as MathML; its variables, of one letter, have the class ``variable``.

    Parameters
    ----------
    tex : LaTeX
    block : whether it stands on lines of its own
    """
    for unknown, known in _UNKNOWN_TEX.items():
        tex = re.sub(re.escape(unknown) + r"(?![a-zA-Z])", known.replace("\\", r"\\"), tex)
    tex = _NUMBERED.sub(r"\\mathrm{\1}", tex)
    return _VARIABLE.sub(_name_of, convert(tex, display="block" if block else "inline"))


def _name_of(found: re.Match[str]) -> str:
    """Return a variable's element with the class that styles know it by; any other as it is."""
    letter = unescape(found[1])
    known = letter.isalpha() and (ord(letter) in _LETTERS or ord(letter) in _GREEK)
    return f'<mi class="variable">{found[1]}</mi>' if known else found[0]
