"""The question that is hardest to explain, beside a plain one.

``python -m tools.bench.recommendations``. Every parameter is asked and nothing is met. Looking at
all subsets of 20 requirements would take a million answers; explaining must cost no more than a few
hundred.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from registry.recommendation import recommend
from registry.requirements import ATTRIBUTES, EXCLUDE, HAZARDS
from registry.studies import Facts, facts
from tools.bench import comparing
from tools.bench.comparing import Subject
from tools.bench.verdicts import Verdict

_LIMIT = 300.0
_REPEATS = 5


def worst_question(known: Facts) -> Mapping[str, object]:
    """Return requirements that exclude and include everything and ask for the impossible."""
    values = {name: list(known.taxonomy.values(name)) for name in ATTRIBUTES}
    return {
        **values,
        **{EXCLUDE + name: every for name, every in values.items()},
        "max_error_deg": 1e-9,
        "min_fov_deg": 360.0,
        "min_availability": 1.0,
        "max_latency_us": 1e-9,
        "survive": list(HAZARDS),
        "properties": list(known.properties),
    }


def subjects() -> list[Subject]:
    """Prepare the pair."""
    known = facts()
    asked = worst_question(known)
    return [
        Subject(
            name="explaining why nothing meets every requirement at once",
            reference_name="an answer to no requirement",
            call=lambda: recommend(asked, facts=known),
            reference=lambda: recommend({}, facts=known),
            items=1,
            reference_items=1,
            limit=_LIMIT,
        )
    ]


def run() -> list[Verdict]:
    """Measure and print; return the verdicts."""
    return comparing.run(subjects(), _REPEATS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    return comparing.main("tools.bench.recommendations", subjects, _REPEATS, arguments)


if __name__ == "__main__":
    sys.exit(main())
