"""Formulas of docstrings, which are plain text there, as LaTeX.

Nothing is guessed: a quotient becomes a fraction only where there is one way to read it, and stays
a slash elsewhere; a text that is no formula, or has a sign that is not known here, stays as it is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_TOKENS = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>[A-Za-z]+)(?P<digits>\d*)"
    r"|(?P<sign><-|<=|>=|\+-|-\+|\.\.\.|\.\.|[-+/=<>~(),.|^_'!\[\]{}])"
)
#: What stands below a name: an index, several, or the sign of a direction.
_BELOW = re.compile(r"_(?:[A-Za-z0-9]+(?:,[A-Za-z0-9]+)?(?:[+-](?=[,)\s]|$))?|[+-][a-z]?)")
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
        *("max", "min", "arg"),
    )
)
_OPERATORS = frozenset(("argmax", "argmin", "mean", "int", "conj", "sign", "atan2"))
_UNITS = frozenset(("px", "mm", "um", "us", "deg"))
_SIGNS = {
    "=": "=",
    "<": "<",
    ">": ">",
    "<=": r"\le",
    ">=": r"\ge",
    "~": r"\sim",
    "<-": r"\leftarrow",
    "+": "+",
    "-": "-",
    "+-": r"\pm",
    "-+": r"\mp",
    ",": ",",
}
_BETWEEN = frozenset(_SIGNS)
_DOTS = {"...": r"\dots", "..": r"\dots", ".": r"\cdot"}
_OPEN = {"(": ")", "[": "]", "{": "}"}
#: Words of a sentence: what has one is no formula.
_PROSE = frozenset(("of", "at", "the", "an", "in", "on"))
_NAME = re.compile(r"[\w.-]*")


class _NoFormulaError(ValueError):
    """A text that is no formula."""


@dataclass
class _Token:
    kind: str
    text: str
    spaced: bool  # whether there is space before it
    digits: str = ""


@dataclass
class _Factor:
    """A factor of a product; ``bare`` is what is within its parentheses, if it is but these."""

    tex: str
    bare: str | None = None
    sums: bool = False  # the sign of a sum over all that follows


@dataclass
class _Reader:
    tokens: list[_Token]
    at: int = 0
    closing: list[str] = field(default_factory=list)

    def peek(self) -> str:
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def take(self) -> _Token:
        if self.at >= len(self.tokens):
            raise _NoFormulaError
        self.at += 1
        return self.tokens[self.at - 1]

    def ended(self) -> bool:
        return self.at >= len(self.tokens) or (
            bool(self.closing) and self.peek() == self.closing[-1]
        )

    def whole(self) -> str:
        """Read terms and the signs between them, up to the end or what closes a group."""
        parts = []
        while not self.ended():
            if self.peek() in _BETWEEN:
                parts.append(_SIGNS[self.take().text])
            else:
                parts.append(self.term())
        return " ".join(parts)

    def term(self) -> str:
        """Read a product with its quotients."""
        sides: list[list[_Factor]] = [[]]
        while not self.ended() and self.peek() not in _BETWEEN:
            if self.peek() == "/":
                self.take()
                sides.append([])
            else:
                sides[-1].append(self.factor())
        if not all(sides):
            raise _NoFormulaError
        return _quotient(sides)

    def factor(self) -> _Factor:
        token = self.take()
        if token.kind == "number":
            return self.raise_power(_Factor(token.text))
        if token.text in _DOTS:
            return _Factor(_DOTS[token.text])
        if token.text in _OPEN or token.text == "|":
            return self.raise_power(self.group(token.text))
        if token.kind == "name":
            return self.named(token)
        raise _NoFormulaError

    def group(self, opening: str) -> _Factor:
        closing = _OPEN.get(opening, "|")
        self.closing.append(closing)
        within = self.whole()
        if self.take().text != closing or not within:
            raise _NoFormulaError
        self.closing.pop()
        left, right = (r"\{", r"\}") if opening == "{" else (opening, closing)
        tex = rf"\left{left} {within} \right{right}"
        return _Factor(tex, bare=within if opening == "(" else None)

    def named(self, token: _Token) -> _Factor:
        name = token.text
        if name + token.digits in _OPERATORS:
            name, token.digits = name + token.digits, ""
        if name == "sqrt" and self.peek() == "(":
            root = self.group(self.take().text)
            return self.raise_power(_Factor(rf"\sqrt{{{root.bare}}}"))
        tex = _format_value(name)
        below = _format_value(token.digits) if token.digits else ""
        primes = self.primes()
        if self.peek().startswith("_"):
            below = self.below()
        primes += self.primes()
        above = self.above()
        up = r"\prime " * primes + above
        tex += (f"_{{{below}}}" if below else "") + (f"^{{{up.strip()}}}" if up else "")
        if name == "sum":
            return self.add_up(tex)
        # A name and what stands in brackets close to it: a function of that, an entry of a table.
        while self.peek() in {"(", "["} and not self.tokens[self.at].spaced:
            tex = f"{tex} {self.group(self.take().text).tex}"
        return self.factorial(_Factor(tex))

    def add_up(self, tex: str) -> _Factor:
        """Read what a sum is over where that stands in parentheses close to it."""
        if self.peek() != "(" or self.tokens[self.at].spaced:
            return _Factor(tex, sums=True)
        over = self.group(self.take().text)
        last = self.ended() or self.peek() in _BETWEEN or self.peek() == "/"
        plain = over.bare is not None and not re.search(r"(?<!^)[-+=] |\\pm|\\mp", over.bare)
        return self.raise_power(_Factor(f"{tex} {over.bare if last and plain else over.tex}"))

    def raise_power(self, factor: _Factor) -> _Factor:
        above = r"\prime " * self.primes() + self.above()
        if above:
            factor = _Factor(f"{factor.tex}^{{{above.strip()}}}")
        return self.factorial(factor)

    def factorial(self, factor: _Factor) -> _Factor:
        if self.peek() != "!":
            return factor
        self.take()
        return _Factor(f"{factor.tex} !")

    def primes(self) -> int:
        count = 0
        while self.peek() == "'":
            self.take()
            count += 1
        return count

    def below(self) -> str:
        text = self.take().text[1:]
        if text:
            sign = re.fullmatch(r"([+-]?)([A-Za-z0-9,]*)([+-]?)", text)
            if sign is None:
                raise _NoFormulaError
            names = ", ".join(
                _format_value(name, below=True) for name in sign[2].split(",") if name
            )
            return f"{sign[1]}{names}{sign[3]}"
        if self.peek() not in {"(", "{"}:
            raise _NoFormulaError
        opening = self.take().text
        self.closing.append(_OPEN[opening])
        within = self.whole()
        if self.take().text != self.closing.pop():
            raise _NoFormulaError
        return within

    def above(self) -> str:
        if self.peek() != "^":
            return ""
        self.take()
        sign = self.take().text if self.peek() == "-" else ""
        token = self.take()
        if token.kind not in {"number", "name"}:
            raise _NoFormulaError
        tex = _format_value(token.text + token.digits)
        if self.peek().startswith("_"):
            tex += f"_{{{self.below()}}}"
        return sign + tex


def tex(text: str) -> str | None:
    r"""Return a formula as LaTeX; None for what is none.

    Examples
    --------
    >>> tex("x_c = sum(x I) / sum(I)")
    'x_{c} = \\frac{\\sum x \\, I}{\\sum I}'
    >>> tex("extract") is None
    True
    """
    if _is_name(text):
        return None
    try:
        reader = _Reader(_tokens(text))
        found = reader.whole()
    except _NoFormulaError:
        return None
    return found if reader.at == len(reader.tokens) else None


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


def _tokens(text: str) -> list[_Token]:
    found: list[_Token] = []
    at, spaced = 0, False
    while at < len(text):
        below = _BELOW.match(text, at)
        match = below or _TOKENS.match(text, at)
        if match is None:
            raise _NoFormulaError
        kind = "below" if below else (match.lastgroup or "")
        if kind == "space":
            spaced = True
        elif not below and match["name"]:
            if match["name"] in _PROSE:
                raise _NoFormulaError
            found.append(_Token("name", match["name"], spaced, match["digits"]))
            spaced = False
        else:
            found.append(_Token(kind, match[0], spaced))
            spaced = False
        at = match.end()
    return found


def _quotient(sides: list[list[_Factor]]) -> str:
    """Write a product with quotients: as a fraction where there is one way to read it."""
    if len(sides) == 2:
        above, below = sides
        sums = any(factor.sums for factor in below)
        over_sum = any(factor.sums for factor in above)
        single = len(below) == 1 or below[0].sums
        if single and (sums or not over_sum):
            return rf"\frac{{{_inside(above)}}}{{{_inside(below)}}}"
    return " / ".join(_product(side) for side in sides)


def _inside(side: list[_Factor]) -> str:
    """Write what a fraction's line holds together, without parentheses for that."""
    if len(side) == 1 and side[0].bare is not None and " , " not in side[0].bare:
        return side[0].bare
    return _product(side)


def _product(factors: list[_Factor]) -> str:
    """Write factors with a narrow space between them, or two letters look like one name."""
    spaced = [f"{one.tex} " if one.sums else rf"{one.tex} \, " for one in factors[:-1]]
    return "".join(spaced) + factors[-1].tex


def _format_value(name: str, *, below: bool = False) -> str:
    """Write a name: Greek, a function, letters, or a word."""
    if name in _GREEK:
        return f"\\{name}"
    if name in {"sum", "grad"}:
        return {"sum": r"\sum", "grad": r"\nabla"}[name]
    if not below and name in _FUNCTIONS:
        return rf"\{name}" if name != "arg" else r"\operatorname{arg}"
    if not below and name in _OPERATORS:
        return rf"\operatorname{{{name}}}"
    if name in _UNITS or (len(name) > 2 and name.isalpha()):
        return rf"\mathrm{{{name}}}"
    return name
