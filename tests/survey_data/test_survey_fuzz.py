"""No file, however mangled, makes validation or loading crash."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import survey_data
from survey_data.descriptor import column_types, table_names

SETTINGS = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
}
INTERESTING = st.one_of(
    st.binary(max_size=8),
    st.sampled_from(
        [b'"', b'""', b",", b"\n", b"\r", b"\r\n", b"\x00", b"\xff", b"\xef\xbb\xbf", b"1e999",
         b"None", b"nan", b"-", b"9" * 5000, "\u2028".encode(), "\u0663".encode(), b"|", b">", b"+"]
    ),
)  # fmt: skip


@st.composite
def mutations(draw: st.DrawFn) -> list[tuple[float, int, bytes]]:
    """Edits at a relative position: bytes removed, bytes put in."""
    edit = st.tuples(st.floats(0, 1), st.integers(0, 12), INTERESTING)
    return draw(st.lists(edit, min_size=1, max_size=4))


def mutate(data: bytes, edits: list[tuple[float, int, bytes]]) -> bytes:
    for position, removed, added in edits:
        at = int(position * len(data))
        data = data[:at] + added + data[at + removed :]
    return data


@pytest.mark.slow
@given(st.data())
@settings(max_examples=12, **SETTINGS)
def test_random_cells_give_problems_or_stay_valid(copy: Any, data: st.DataObject) -> None:
    # well-formed CSV with any text in one cell: types, keys, grammar and rules are reached
    filled = [table for table in table_names() if len(copy.rows(table)) > 1]
    table = data.draw(st.sampled_from(filled))
    rows = copy.rows(table)
    row = data.draw(st.integers(2, len(rows)))
    column = data.draw(st.sampled_from(list(column_types(table))))
    others = [cells[rows[0].index(column)] for cells in rows[1:]]
    text = data.draw(st.one_of(st.text(max_size=20), st.sampled_from(others)))
    before = copy.path(table).read_bytes()
    try:
        copy.set(table, row, column, text)
        problems = survey_data.validate(copy.directory)
        assert all(p.message for p in problems)
        if not problems:
            assert survey_data.fidelity(survey_data.load(copy.directory)).studies == 129
    finally:
        copy.path(table).write_bytes(before)


@pytest.fixture(scope="module")
def workbook(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["Key", "Mask"])
    book.active.append(["Chang2008", "Pinhole"])
    path = tmp_path_factory.mktemp("book") / "theirs.xlsx"
    book.save(path)
    return path.read_bytes()


@given(mutations())
@settings(max_examples=60, **SETTINGS)
def test_a_mangled_workbook_is_read_or_refused(
    copy: Any, workbook: bytes, edits: list[tuple[float, int, bytes]]
) -> None:
    path = copy.directory / "theirs.xlsx"
    path.write_bytes(mutate(workbook, edits))
    try:
        columns = list(survey_data.read_table(path).columns)
    except survey_data.SurveyImportError as error:
        columns = [str(error)]
    assert columns
