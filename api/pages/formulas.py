"""Formulas of docstrings, which are plain text there, as LaTeX.

Signs and names are replaced one by one, and quotients stay a slash; a text that is no formula, or
has a sign that is not known here, stays as it is.
"""

from __future__ import annotations

import re

_TOKENS = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<below>_(?:[A-Za-z0-9]+(?:,[A-Za-z0-9]+)?(?:[+-](?=[,)\s]|$))?|[+-][a-z]?(?![({])))"
    r"|(?P<above>\^-?[A-Za-z0-9]+)"
    r"|(?P<root>sqrt\()"
    r"|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>atan2|[A-Za-z]+)(?P<digits>\d*)"
    r"|(?P<open>_?[(\[{])|(?P<close>[)\]}])"
    r"|(?P<sign><-|<=|>=|\+-|-\+|\.\.\.|\.\.|[-+/=<>~,.|'!])"
)
_GREEK = frozenset(
    (
        *("alpha", "beta", "gamma", "delta", "epsilon", "eta", "theta", "kappa", "lambda", "mu"),
        *("nu", "xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Gamma", "Delta"),
        *("Theta", "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega"),
    )
)
_FUNCTIONS = frozenset(
    (
        *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "tanh", "exp", "log", "det"),
        *("max", "min"),
    )
)
_OPERATORS = frozenset(("arg", "argmax", "argmin", "mean", "int", "conj", "sign", "atan2"))
_SIGNS = {
    "<=": r"\le",
    ">=": r"\ge",
    "~": r"\sim",
    "<-": r"\leftarrow",
    "+-": r"\pm",
    "-+": r"\mp",
    "...": r"\dots",
    "..": r"\dots",
    ".": r"\cdot",
    "sum": r"\sum",
    "grad": r"\nabla",
}
_CLOSING = {"(": ")", "[": "]", "{": "}"}
#: Words of a sentence: what has one is no formula.
_PROSE = frozenset(("of", "at", "the", "an", "in", "on"))
_UNITS = frozenset(("px", "mm", "um", "us"))
_NAME = re.compile(r"[\w.-]*")


def tex(text: str) -> str | None:  # noqa: C901, PLR0912 - a case for each kind of sign
    r"""Return a formula as LaTeX; None for what is none.

    Examples
    --------
    >>> tex("x_c = sum(x I) / sum(I)")
    'x_{c} = \\sum (x \\, I) / \\sum (I)'
    >>> tex("extract") is None
    True
    """
    if _is_name(text):
        return None
    parts: list[str] = []
    closing: list[tuple[str, str]] = []
    at, spaced, operand = 0, False, False
    while at < len(text):
        match = _TOKENS.match(text, at)
        if match is None or match["name"] in _PROSE:
            return None
        found, at = match[0], match.end()
        if match["space"]:
            spaced = True
            continue
        # Factors with a narrow space between them, or two letters look like one name.
        narrow = operand and spaced and (match["number"] or match["name"] or match["open"])
        parts += [r"\,"] if narrow or (operand and match["root"]) else []
        spaced = False
        operand = bool(match["number"] or match["name"] or match["close"] or operand)
        if match["sign"]:
            if found == "'" and not operand:
                return None
            operand = found in "'!|"
            parts.append(_SIGNS.get(found, found))
        elif match["below"] or match["above"]:
            if not parts:
                return None
            parts[-1] += f"{found[0]}{{{_script(found[1:])}}}"
        elif match["root"] or match["open"]:
            grouped = found[0] in "s_"
            written = r"\sqrt{" if match["root"] else "_{" if grouped else found
            closing.append((_CLOSING[found[-1]], "}" if grouped else ""))
            parts.append(r"\{" if written == "{" else written)
            operand = False
        elif match["close"]:
            expected, written = closing.pop() if closing else ("", "")
            if found != expected:
                return None
            parts.append(written or (r"\}" if found == "}" else found))
        elif match["name"]:
            parts.append(_word(match["name"]) + (f"_{{{match['digits']}}}" * bool(match["digits"])))
        else:
            parts.append(found)
    return None if closing else " ".join(parts).replace("( ", "(").replace(" )", ")")


def _is_name(text: str) -> bool:
    """Say whether a text is a name of code: a word, a path, words joined by hyphens."""
    if _NAME.fullmatch(text) is None:
        return False
    first = re.match(r"[A-Za-z]*", text)
    base = first[0] if first else ""
    return (
        not text
        or text[0] in "-."
        or "-" in text
        or "." in text
        or (len(base) > 1 and base not in _GREEK)
    )


def _script(text: str) -> str:
    """Write what stands below or above a name: an index, several, or the sign of a direction."""
    return re.sub(r"[A-Za-z]+", lambda word: _word(word[0], script=True), text)


def _word(name: str, *, script: bool = False) -> str:
    """Write a name: Greek, a function, letters, or a word."""
    if name in _GREEK:
        return f"\\{name}"
    if name in _SIGNS:
        return _SIGNS[name]
    if not script and name in _FUNCTIONS:
        return rf"\{name}"
    if not script and name in _OPERATORS:
        return rf"\operatorname{{{name}}}"
    return rf"\mathrm{{{name}}}" if name in _UNITS or len(name) > 2 else name
