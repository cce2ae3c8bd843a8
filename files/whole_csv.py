"""Records of a CSV file that is whole: a plain file, cut nowhere, every letter as it was written.

`strict_csv` reads what stands in the lines; here is what a file must be before that.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from files.problems import Problem
from files.reading import FileRefusedError, read_bytes
from files.strict_csv import Records, read_records

#: Stands where an earlier program lost a letter.
_LOST = "\ufffd"


def read_whole_records(path: Path, columns: Sequence[str]) -> Records:
    """Read a CSV file as `strict_csv.read_records` does, and report what is damaged beyond that.

    Parameters
    ----------
    path : the file
    columns : expected header

    Returns
    -------
    Records
        With a problem, and no rows, for a directory, a pipe, a loop of links or a file that is too
        large; and with problems beside the rows for a last line that is cut off and for letters
        that were lost.
    """
    refused = Records()
    try:
        data = read_bytes(path)
    except FileNotFoundError:
        refused.problems.append(Problem(path.name, None, None, "the file is missing"))
        return refused
    except FileRefusedError as error:
        refused.problems.append(Problem(path.name, None, None, error.reason))
        return refused
    records = read_records(path, columns)
    if data and not data.endswith(b"\n"):
        last = data.count(b"\n") + 1
        records.problems.append(Problem(path.name, last, columns[-1], "the last line is cut off"))
    for row, cells in records.rows:
        for column, cell in zip(columns, cells, strict=False):
            if _LOST in cell:
                said = "U+FFFD, a letter that was lost 0xfffd"
                records.problems.append(Problem(path.name, row, column, said))
    return records
