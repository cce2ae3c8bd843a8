"""Rules, plans and explanations of claims that cannot be read are refused by name."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmark.claims import rules
from benchmark.claims.rules import DIRECTORY, RulesError, claims


@pytest.fixture
def tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str, str], None]:
    """Return a function that replaces text in a copy of one of the tables."""
    for name in ("rules.csv", "trials.csv"):
        (tmp_path / name).write_bytes((DIRECTORY / name).read_bytes())
    monkeypatch.setattr(rules, "DIRECTORY", tmp_path)

    def change(name: str, old: str, new: str) -> None:
        text = (tmp_path / name).read_text("utf-8")
        changed = re.sub(old, new, text, count=1, flags=re.MULTILINE)
        assert changed != text
        (tmp_path / name).write_text(changed, "utf-8")

    return change


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("trials.csv", r"^(C04,.*\n)", r"\1\1", r"trials\.csv: claim C04 stands there twice"),
        ("trials.csv", r"^(C04,[^,]*),[^,]*", r"\1,4", "C04 plans 4 trials; at least 5"),
        ("trials.csv", r"^(C04,[^,]*),[^,]*", r"\1,six", "claim C04, trials: .*'six'"),
        ("trials.csv", r"^(C04,[^,]*,[^,]*),[^,]*", r"\1,day", "C04: expected one of unit, seed"),
        ("trials.csv", r"^(C04,)", r"C04,more,\1", r"trials\.csv.*row"),
        ("rules.csv", r"^(C04,little,.*,)0\.9,", r"\1little,", "C04 little, limit: .*'little'"),
        ("rules.csv", r"^claim,rule", "claim,law", r"rules\.csv.*'rule'|rules\.csv.*law"),
    ],
)
def test_a_table_that_cannot_decide_claims_is_refused_by_name(
    tables: Callable[[str, str, str], None], name: str, old: str, new: str, said: str
) -> None:
    tables(name, old, new)
    with pytest.raises(RulesError, match=said):
        claims.__wrapped__()
