"""Questions drawn of all parameters, of the vocabulary of the survey."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from registry.requirements import EVIDENCE, EXCLUDE, HAZARDS, MISSIONS, NEEDS
from registry.studies import Facts
from registry.taxonomy import ATTRIBUTES

#: Of each number: how often it is asked, and the ends of its range on a logarithmic scale.
_NUMBERS = {
    "max_error_deg": (0.3, 0.002, 3.0),
    "min_fov_deg": (0.25, 20.0, 360.0),
    "min_availability": (0.06, 0.5, 1.0),
    "max_latency_us": (0.06, 1.0, 1000.0),
    "max_mass_g": (0.08, 5.0, 1000.0),
    "max_power_mw": (0.08, 5.0, 1000.0),
    "min_rate_hz": (0.08, 0.5, 500.0),
    "bench_deg": (0.25, 0.001, 0.1),
    "confidence": (0.2, 0.5, 0.999),
    "sun_distance_au": (0.08, 0.05, 10.0),
    "processor": (0.1, 0.2, 5.0),
}
#: Of each list: how often it is asked, and its most values.
_LISTS = {
    "task": (0.25, 2), "error": (0.1, 2), "accuracy": (0.2, 2), "detector": (0.15, 3),
    "mask": (0.15, 3), "model": (0.12, 4), "extractor": (0.12, 4), "tolerate": (0.1, 2),
    "properties": (0.06, 2), "exclude_needs": (0.1, 2),
}  # fmt: skip


def drawn_questions(number: int, seed: int, facts: Facts) -> Iterator[dict[str, Any]]:
    """Yield questions, some of them empty."""
    rng = np.random.default_rng(seed)
    known = {name: facts.taxonomy.values(name) for name in ATTRIBUTES}
    known |= {"tolerate": tuple(HAZARDS), "properties": tuple(facts.properties)}
    known["exclude_needs"] = tuple(NEEDS)
    for _ in range(number):
        ask: dict[str, Any] = {}
        for name, values in known.items():
            share, most = _LISTS[name]
            if rng.random() < share:
                ask[name] = _some(rng, values, most)
            if name in ATTRIBUTES and rng.random() < 0.08:
                ask[EXCLUDE + name] = _some(rng, values, most)
        for name, (share, least, most) in _NUMBERS.items():
            if rng.random() < share:
                ask[name] = float(f"{np.exp(rng.uniform(np.log(least), np.log(most))):.3g}")
        if "bench_deg" in ask and rng.random() < 0.15:
            ask["bench_deg"] = 0.0
        if rng.random() < 0.15:
            ask["evidence"] = str(rng.choice(EVIDENCE))
        if rng.random() < 0.05:
            ask["mission"] = str(rng.choice(list(MISSIONS)))
        yield ask


def _some(rng: np.random.Generator, values: Iterable[str], most: int) -> list[str]:
    every = list(values)
    return sorted(rng.choice(every, rng.integers(1, most + 1), replace=False).tolist())
