"""An Excel workbook as rows of cells: the sheet with most numbers, its header found."""

from __future__ import annotations

import datetime as dt
import io

import numpy as np
import pandas as pd

from calibrate.forms.layout import SAMPLED, is_comment, layout_of, numeric_share
from calibrate.forms.refused import TableError
from calibrate.forms.text import Cells
from calibrate.settings import FileSettings


def cells_of_workbook(data: bytes, source: str, stated: FileSettings, most_rows: int) -> Cells:
    """Return the cells of a workbook's sheet.

    Parameters
    ----------
    data : bytes
        Of the file.
    source : str
        Its name, for messages.
    stated : FileSettings
        What the reader says of it; the rest is found.
    most_rows : int
        Rows that are taken at most of each sheet.

    Raises
    ------
    TableError
        If it is no workbook, or has no such sheet.
    """
    try:
        sheets = pd.read_excel(
            io.BytesIO(data), sheet_name=None, header=None, nrows=most_rows, dtype=object
        )
    except Exception as error:  # noqa: BLE001 - openpyxl raises many kinds for damaged files
        raise TableError(f"{source}: expected an Excel workbook ({str(error)[:80]})") from None
    if stated.sheet is not None and stated.sheet not in sheets:
        raise TableError(
            f"{source}: no sheet {stated.sheet!r} (there are {', '.join(map(str, sheets))})"
        )
    texts = {str(name): sheet.map(_as_text) for name, sheet in sheets.items()}
    name = stated.sheet or max(texts, key=lambda word: _numbers_in(texts[word]))
    frame = texts[name]
    top = [[str(cell) for cell in row] for row in frame.head(SAMPLED).itertuples(index=False)]
    comments = [bool(row) and is_comment(row[0]) for row in top]
    layout = layout_of(top, comments, stated.header_row)
    places = np.arange(len(frame))
    blank = (frame == "").all(axis=1).to_numpy(dtype=np.bool_)
    kept = (places >= layout.data) & ~blank
    sheet = [f"sheet {name} of {', '.join(texts)} was read"] if len(sheets) > 1 else []
    body = frame[kept].reset_index(drop=True)
    notes = (*sheet, *layout.notes())
    return Cells(
        body, layout.names, layout.unit_cells, places[kept] + 1, ".", layout.header_row, notes
    )


def _numbers_in(sheet: pd.DataFrame) -> float:
    """Numbers of a sheet, estimated by its first rows."""
    rows = [list(row) for row in sheet.head(SAMPLED).itertuples(index=False)]
    shares = [max(numeric_share(row), 0.0) * len(row) for row in rows]
    return float(np.mean(shares)) * len(sheet) if shares else 0.0


def _as_text(cell: object) -> str:
    if isinstance(cell, (dt.datetime, dt.date)):
        return cell.isoformat()
    if cell is None or cell is pd.NaT or (isinstance(cell, float) and np.isnan(cell)):
        return ""
    return str(cell).strip()
