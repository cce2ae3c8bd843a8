"""Facts about the mapped sun-sensor studies: tables, their validation, fidelity and import.

The data are the CSV files beside this file, described by `datapackage.json`. Importing the
package is cheap: pandas, frictionless and openpyxl load with the first function that needs them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey_data.fidelity_report import FidelityReport, fidelity
    from survey_data.findings import FindingVerdict
    from survey_data.import_columns import ColumnMapping, match_columns
    from survey_data.import_plan import Difference, ImportPlan, differences, plan_import
    from survey_data.import_reading import read_table
    from survey_data.problems import Problem, SurveyDataError, SurveyImportError
    from survey_data.table_import import apply_import, import_table
    from survey_data.tables import SurveyTables, load
    from survey_data.validation import validate

__all__ = [
    "ColumnMapping",
    "Difference",
    "FidelityReport",
    "FindingVerdict",
    "ImportPlan",
    "Problem",
    "SurveyDataError",
    "SurveyImportError",
    "SurveyTables",
    "apply_import",
    "differences",
    "fidelity",
    "import_table",
    "load",
    "match_columns",
    "plan_import",
    "read_table",
    "validate",
]

_HOMES = {
    "ColumnMapping": "import_columns",
    "Difference": "import_plan",
    "FidelityReport": "fidelity_report",
    "FindingVerdict": "findings",
    "ImportPlan": "import_plan",
    "Problem": "problems",
    "SurveyDataError": "problems",
    "SurveyImportError": "problems",
    "SurveyTables": "tables",
    "apply_import": "table_import",
    "differences": "import_plan",
    "fidelity": "fidelity_report",
    "import_table": "table_import",
    "load": "tables",
    "match_columns": "import_columns",
    "plan_import": "import_plan",
    "read_table": "import_reading",
    "validate": "validation",
}


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(importlib.import_module(f"{__name__}.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
