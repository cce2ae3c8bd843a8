"""A small sample of the campaign of damaged files: `make faults` tries a thousand."""

import pytest

from tools.faults.campaign import FAULTS, cases
from tools.faults.kinds import GIVEN
from tools.faults.kinds_measured import MEASURED

NAMES = ("facts", "table", "bibl", "times", "saved", "journal", "export, forged", "claim")
#: Every file is read by all that reads it: half a second and more.
KINDS = [
    pytest.param(kind, marks=() if kind.name.startswith(("facts", "times")) else pytest.mark.slow)
    for kind in (*GIVEN, *MEASURED)
    if kind.name.startswith(NAMES)
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_no_damaged_file_is_taken_wrongly_or_ends_in_a_traceback(kind, tmp_path):
    count = 2 if kind.name.startswith("claim") else 4  # each looks through all code
    tried = list(cases(kind, count, 2, tmp_path))
    assert len(tried) == count
    assert [case for case in tried if case.outcome in FAULTS] == []
