"""Formulas of docstrings, typeset: nothing lost, nothing read in another way than it is written."""

import html
import re
from collections import Counter

import pytest

from api.mathml import mathml
from api.pages.formulas import tex
from api.pages.methods import mark_up
from registry.catalogue import catalogue

LITERAL = re.compile(r"``([^`]+)``")
_GREEK = ("alpha", "beta", "delta", "epsilon", "eta", "theta", "kappa", "lambda", "mu", "nu")
_MORE = ("xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Delta", "Psi")
#: How signs are drawn that stand as words in plain text.
DRAWN = {
    "sum": "∑",
    "grad": "∇",
    "sqrt": "",
    **dict(zip((*_GREEK, *_MORE), "αβδϵηθκλμνξπρστϕχψωΔΨ", strict=True)),
}


@pytest.mark.parametrize(
    ("plain", "written"),
    [
        ("x_c = sum(x I) / sum(I)", r"x_{c} = \sum (x \, I) / \sum (I)"),
        ("alpha = arctan(Y s / h)", r"\alpha = \arctan (Y \, s / h)"),
        ("sqrt(a (b + c)) <= 2", r"\sqrt{ a \, (b + c) } \le 2"),
        ("I_max,i", "I_{\\mathrm{max},i}"),
    ],
)
def test_a_formula_is_written_as_it_reads(plain: str, written: str) -> None:
    assert tex(plain) == written


@pytest.mark.parametrize(
    "text",
    ["extract", "LinearPhase", "v-slit", "cv2.calibrateCamera", "temperature_K", "(a",
     "sum of the others' squares", "{'angle', 'tangent'}", "x = ü", "b)", "^2", "x_"],
)  # fmt: skip
def test_what_is_no_formula_stays_as_it_is(text: str) -> None:
    assert tex(text) is None


def names_of(text: str) -> Counter[str]:
    """Letters and digits of a formula or of its MathML, whatever stands between them."""
    text = html.unescape(re.sub(r"<[^>]*>", " ", re.sub(r'alttext="[^"]*"', "", text)))
    for name, letter in DRAWN.items():
        text = re.sub(rf"(?<![A-Za-z]){re.escape(name)}(?![a-z])", letter, text)
    return Counter(c for c in text if c.isalnum())


def test_every_formula_of_an_algorithm_is_typeset_with_all_that_it_says() -> None:
    known = catalogue()
    plain, typeset = set(), set()
    for made in (*known.extractors.values(), *known.models.values()):
        for cls in getattr(made, "stages", (made,)):
            for literal in LITERAL.findall(cls.__doc__ or ""):
                text = " ".join(literal.split())
                written = tex(text)
                (plain if written is None else typeset).add(text)
                if written is not None:
                    assert names_of(mathml(written)) == names_of(text), text
    assert len(typeset) > 200
    (left,) = {text for text in plain if re.search(r"[=+<>/^]|\) -", text)}
    assert left.count("sum(I at ") == 2


def test_a_text_links_the_studies_that_it_names_and_keeps_its_code() -> None:
    said = mark_up("Implements: alg:BCM (Chang2008): ``x = a / b`` by `Some2099`, <not> ``track``")
    assert '(<a href="/studies/Chang2008">Chang2008</a>)' in said
    assert mark_up("``a = b``, then").endswith("</math>,</span> then")
    assert '<span title="alg:BCM">Algorithm 5</span>' in said
    assert 'alttext="x = a / b"' in said
    assert "<code>Some2099</code>, &lt;not&gt; <code>track</code>" in said
