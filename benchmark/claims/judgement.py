"""From the trials of a statistic to a verdict on a claim.

Of every rule's statistic the mean over trials is taken with Student's 95 % interval (of logarithms
where the rule says so). A rule *holds* where the whole interval is on its side of the limit,
*fails* where the whole interval is on the other, and is *open* between. A claim is reproduced where
all of its rules hold, partly where some do, refuted where none holds and one fails; where all are
open, these trials cannot decide, and it is not testable. What is published depends on the second
reading, too (`review.published`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from benchmark.claims.rules import FEWEST_TRIALS, Rule, Verdict

RuleResult = Literal["holds", "fails", "open"]

#: Of the interval.
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Judgement:
    """A rule's statistic over the trials, and whether it holds.

    Mean over the trials that gave a number (of their logarithms, taken back) and its 95 % interval;
    NaN where these are fewer than `FEWEST_TRIALS`.
    """

    rule: Rule
    estimate: float
    low: float
    high: float
    trials: int
    result: RuleResult


def judge(rule: Rule, values: Sequence[float]) -> Judgement:
    """Judge a rule by the values (T,) that its statistic took; NaN where a trial gave none."""
    given = np.asarray(values, dtype=np.float64)
    given = given[~np.isnan(given)]
    if len(given) < FEWEST_TRIALS:
        return Judgement(rule, math.nan, math.nan, math.nan, len(given), "open")
    if rule.scale == "linear":
        estimate, low, high = _interval(given)
    elif (given < 0).any():
        raise ValueError(
            f"{rule.name}: a statistic averaged by logarithms is never negative; got {given.min()}"
        )
    else:
        estimate, low, high = _of_logarithms(given)
    return Judgement(rule, estimate, low, high, len(given), _result(rule, low, high))


def verdict(rules: Iterable[Judgement]) -> Verdict:
    """Return what the rules of a claim say together; ValueError for none."""
    results = [rule.result for rule in rules]
    if not results:
        raise ValueError("a verdict needs at least one judged rule; got none")
    if all(result == "holds" for result in results):
        return "reproduced"
    if "holds" in results:
        return "partly"
    return "refuted" if "fails" in results else "not testable"


def _interval(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[float, float, float]:
    n = len(values)
    mean = float(np.mean(values))
    from scipy.special import stdtrit  # noqa: PLC0415 - the service starts without SciPy

    student = stdtrit(n - 1, 0.5 + CONFIDENCE / 2)  # scipy.stats takes half a second to import
    half = float(student * np.std(values, ddof=1) / math.sqrt(n))
    return mean, mean - half, mean + half


def _of_logarithms(
    values: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> tuple[float, float, float]:
    if not (values > 0).all() or np.isinf(values).any():
        # an error of zero, or a ratio to one: beyond every limit, or the trials disagree utterly
        same = float(values[0]) if (values == values[0]).all() else math.nan
        return (same, same, same) if not math.isnan(same) else (math.nan, 0.0, math.inf)
    mean, low, high = _interval(np.log(values))
    return math.exp(mean), math.exp(low), math.exp(high)


def _result(rule: Rule, low: float, high: float) -> RuleResult:
    if rule.relation == "within":
        if rule.limit <= low and high <= rule.upper:
            return "holds"
        return "fails" if high < rule.limit or low > rule.upper else "open"
    if rule.relation == ">":
        return "holds" if low > rule.limit else "fails" if high <= rule.limit else "open"
    if rule.relation == ">=":
        return "holds" if low >= rule.limit else "fails" if high < rule.limit else "open"
    if rule.relation == "<":
        return "holds" if high < rule.limit else "fails" if low >= rule.limit else "open"
    return "holds" if high <= rule.limit else "fails" if low > rule.limit else "open"
