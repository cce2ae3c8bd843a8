"""Code that hands stages on and keeps them moves no digest; code that makes numbers does."""

from pathlib import Path

import pytest

from benchmark.results.analyses import Analyses
from benchmark.results.closure import Sources, module_path, reachable_definitions
from benchmark.results.definitions import Definitions, analyse
from benchmark.results.digests import STAGES, stage_digests

#: What plans, hands out, times, stores and locks. It changes no number, and no stage may reach it.
INFRASTRUCTURE = (
    "files",
    "benchmark.plan",
    "benchmark.results",
    *(
        f"benchmark.running.{name}"
        for name in (
            *("backend", "cluster", "durations", "kept_stages", "pinning", "planned", "runner"),
            *("schedule", "threads", "times", "timing", "workers"),
        )
    ),
)


class Edited(Analyses):
    """Sources as they would be with one edit."""

    def __init__(self, module: str, old: str, new: str) -> None:
        super().__init__()
        self._path = module_path(module)
        assert self._path is not None
        text = self._path.read_text()
        assert old in text
        self._edited = analyse(text.replace(old, new).encode(), str(self._path))

    def of(self, path: Path) -> Definitions:
        return self._edited if path == self._path else Analyses.of_user().of(path)


def moved(module: str, old: str, new: str) -> list[str]:
    """Return the stages whose digest an edit moves."""
    before, after = stage_digests(), stage_digests(Sources(Edited(module, old, new)))
    return [stage for stage in STAGES if before[stage] != after[stage]]


@pytest.mark.parametrize("stage", STAGES)
def test_no_stage_reaches_what_only_hands_it_on(stage: str) -> None:
    found = reachable_definitions(*STAGES[stage])
    assert len(found) > 100
    ours = tuple(f"{name}{end}" for name in INFRASTRUCTURE for end in ".:")
    assert not [one for one in found if one.startswith(ours)]


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("benchmark.running.task", "kept.put(PREDICTIONS", "kept.put(FEATURES"),
        ("benchmark.running.condition_data", "kept.put(DATA", "kept.put(TRUTH"),
    ],
)
def test_an_edit_of_what_keeps_stages_moves_no_digest(module: str, old: str, new: str) -> None:
    assert moved(module, old, new) == []


@pytest.mark.parametrize(
    ("module", "old", "new", "stages"),
    [
        ("benchmark.seeds", "sha256", "sha512", ["data"]),
        ("algorithms.pipeline", "def extract_features(", "def extract_features(*_, ", ["features"]),
        ("benchmark.running.task", "range(BENCHES)", "range(1)", ["predictions"]),
        ("benchmark.metrics.score", "np.arctan2(", "np.hypot(", ["scores"]),
    ],
)
def test_an_edit_of_what_makes_numbers_moves_the_digest_of_its_stage(
    module: str, old: str, new: str, stages: list[str]
) -> None:
    assert set(stages) <= set(moved(module, old, new))
