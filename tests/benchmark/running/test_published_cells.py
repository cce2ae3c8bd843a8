"""Every implementation gives, measured again, the score that was published of it."""

from collections import defaultdict

import pytest

from benchmark.leaderboard.check import compare_scores
from benchmark.plan import combinations as plan
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import runner

#: Cheapest first: an implementation is measured on the first that it fits.
QUICK = (
    "pd-slit", "oi-maskless-pyramid", "pd-maskless-pyramid", "ltf-maskless-cube",
    "pd-single-aperture", "pd-code-dial", "ccd-slit", "ccd-v-slit", "ccd-vernier", "ccd-n-slit",
    "ccd-periodic", "ccd-multi-slit", "cmos-lens", "cmos-encoded-oblique", "pd-albedo-orbit",
)  # fmt: skip
LONG = (
    "cmos-single-aperture-pinhole", "ccd-lens", "cmos-single-aperture-thick", "event-l-slit",
    "pva-orbit", "pd-orbit", "qpd-orbit", "ccd-multi-slit-orbit", "cmos-l-slit",
    "ccd-multi-aperture",
)  # fmt: skip
PLACES = (*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG))


@pytest.fixture(scope="module")
def published():
    return Store(PUBLISHED)


@pytest.fixture(scope="module")
def chosen(published):
    """Cells by data set, each with an extractor or a model that none before it has."""
    scores, known = published.scores(), installed_parts()
    of_set, seen = defaultdict(list), set()
    for name in (*QUICK, *LONG):
        for cell in plan.cells(name, known.presets[name].conditions[0]):
            parts = {("extractor", cell.extractor), ("model", cell.model)}
            if parts - seen and scores[cell]["status"] == "ok":
                of_set[name].append(cell)
                seen |= parts
    assert {name for kind, name in seen if kind == "extractor"} == set(known.extractors)
    assert {name for kind, name in seen if kind == "model"} == set(known.models)
    return of_set


@pytest.mark.parametrize("name", PLACES)
def test_scores_are_those_that_were_published(name, published, chosen, tmp_path):
    store = Store(tmp_path)
    assert runner.run(chosen[name], store).failed == ()
    counts = {place[:2]: pin.n for place, pin in published.pins().items() if place[2] == "test"}
    scores = published.scores()
    wanted = {cell: scores[cell] for cell in chosen[name]}
    assert compare_scores(wanted, store.scores(), counts) == []
