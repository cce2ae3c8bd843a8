"""A small sample of the campaign of damaged files: `make faults` tries a thousand."""

import pytest

from tests.faults.campaign import FAULTS, cases
from tests.faults.kinds import KINDS

QUICK = [kind for kind in KINDS if kind.name.startswith(("facts", "table", "bibl", "times"))]


@pytest.mark.parametrize("kind", QUICK, ids=lambda kind: kind.name)
def test_no_damaged_file_is_taken_wrongly_or_ends_in_a_traceback(kind, tmp_path):
    tried = list(cases(kind, 4, 2, tmp_path))
    assert len(tried) == 4
    assert [case for case in tried if case.outcome in FAULTS] == []
