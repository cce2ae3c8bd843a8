"""The cells that stand in a sheet's file, row by row, and nothing between them.

openpyxl's own rows fill every gap with cells, as far as the sheet says that it reaches.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from openpyxl.worksheet._reader import FORMULA_TAG, ROW_TAG, VALUE_TAG, WorkSheetParser
from openpyxl.xml.functions import iterparse

from survey_data.importing.cells import ERROR, FORMULA, Cell


class _Parser(WorkSheetParser):
    """Reads rows alone: merges, rules and validations say nothing of a table."""

    def rows(self) -> Iterator[tuple[int, list[Cell]]]:
        for _, element in iterparse(self.source):
            if element.tag == ROW_TAG:
                number, cells = self.parse_row(element)
                yield number, [_cell(read) for read in cells]
                element.clear()

    def parse_cell(self, element: Any) -> dict[str, Any]:
        read: dict[str, Any] = super().parse_cell(element)
        computed = element.findtext(VALUE_TAG) or read["data_type"] == "str"
        if element.find(FORMULA_TAG) is not None and read["value"] is None and not computed:
            read["data_type"] = FORMULA
        return read


def _cell(read: dict[str, Any]) -> Cell:
    kind = str(read["data_type"])
    kept = kind if kind in (FORMULA, ERROR) else ""
    return Cell(read["row"], read["column"], read["value"], kept)


def cells_of(workbook: Any, title: str) -> Iterator[tuple[int, list[Cell]]]:
    """Yield (row number, its cells) of a sheet of a workbook opened for reading alone."""
    sheet = workbook[title]
    with sheet._get_source() as source:  # noqa: SLF001 - the stream that its own rows are made of
        yield from _Parser(
            source,
            sheet._shared_strings,  # noqa: SLF001
            data_only=True,
            epoch=workbook.epoch,
            date_formats=workbook._date_formats,  # noqa: SLF001
            timedelta_formats=workbook._timedelta_formats,  # noqa: SLF001
        ).rows()
