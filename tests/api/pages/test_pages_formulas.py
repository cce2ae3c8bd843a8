"""Formulas of docstrings, typeset: nothing lost, nothing read in another way than it is written."""

import html
import re
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
        ("x_c = sum(x I) / sum(I)", r"x_{c} = \frac{\sum x \, I}{\sum I}"),
        ("alpha = arctan(Y s / h)", r"\alpha = \arctan \left( \frac{Y \, s}{h} \right)"),
        ("p'_1 - p'_3 tan(u) = 0", r"p_{1}^{\prime} - p_{3}^{\prime} \, \tan \left( u \right) = 0"),
        ("s = (a, b) / c", r"s = \frac{\left( a , b \right)}{c}"),
        ("(n + K)! / (n! K!)", r"\frac{\left( n + K \right) !}{n ! \, K !}"),
        ("I_max,i", r"I_{\mathrm{max}, i}"),
        ("sum(c p / v) d", r"\sum \left( \frac{c \, p}{v} \right) \, d"),
    ],
)
def test_a_formula_is_written_as_it_reads(plain: str, written: str) -> None:
    assert tex(plain) == written


@pytest.mark.parametrize(
    "text",
    ["extract", "LinearPhase", "v-slit", "cv2.calibrateCamera", "temperature_K", "(a", "a / / b",
     "sum of the others' squares", "{'angle', 'tangent'}", "x = ü", "a /", "b)", "^2", "x_"],
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


LETTERS = st.sampled_from("abcd")
VALUES = {"a": 2.0, "b": 3.0, "c": 5.0, "d": 7.0}


def grouped(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    atom = LETTERS | inner.map("({})".format)
    product = st.lists(atom, min_size=1, max_size=3).map(" ".join)
    quotient = st.builds("{} / {}".format, product, atom)
    return st.lists(product | quotient, min_size=1, max_size=3).map(" + ".join)


def value(text: str) -> float:
    """A formula's value: products before sums, and a quotient from left to right."""
    text = re.sub(r"\\frac\{", "((", text)
    text = text.replace("}{", ") / (").replace("}", "))")
    text = re.sub(r"\\left|\\right|\\,", " ", text)
    spaced = re.sub(r"(?<=[a-d)])\s*(?=[a-d(])", " * ", re.sub(r"\s+", " ", text))
    return float(eval(spaced, {}, VALUES))


@settings(derandomize=True, deadline=None, max_examples=300)
@given(st.recursive(LETTERS, grouped, max_leaves=12))
def test_a_fraction_has_the_value_of_the_quotient(text: str) -> None:
    written = tex(text)
    assert written is not None
    assert value(written) == pytest.approx(value(text))


def test_a_text_links_the_studies_that_it_names_and_keeps_its_code() -> None:
    said = mark_up("Implements: alg:BCM (Chang2008): ``x = a / b`` by `Some2099`, <not> ``track``")
    assert '(<a href="/studies/Chang2008">Chang2008</a>)' in said
    assert "<mfrac>" in said
    assert mark_up("``a = b``, then").endswith("</math>,</span> then")
    assert '<span title="alg:BCM">Algorithm 5</span>' in said
    assert 'alttext="x = a / b"' in said
    assert "<code>Some2099</code>, &lt;not&gt; <code>track</code>" in said
