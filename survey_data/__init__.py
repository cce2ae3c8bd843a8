"""Facts about the mapped sun-sensor studies: tables, their validation, fidelity and import.

The data are the CSV files beside this file, described by `datapackage.json`. Importing the
package is cheap: pandas, frictionless and openpyxl load with the first function that needs them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey_data.findings.checks import FindingVerdict
    from survey_data.findings.report import FidelityReport, fidelity
    from survey_data.importing.columns import ColumnMapping, match_columns
    from survey_data.importing.identities import BibliographyPlan, import_bibliography
    from survey_data.importing.plan import Difference, ImportPlan, plan_import
    from survey_data.importing.table_import import import_table
    from survey_data.importing.table_reader import read_table
    from survey_data.problems import Problem, SurveyDataError, SurveyImportError
    from survey_data.tables import SurveyTables, load
    from survey_data.validation.validate import validate

__all__ = [
    "BibliographyPlan",
    "ColumnMapping",
    "Difference",
    "FidelityReport",
    "FindingVerdict",
    "ImportPlan",
    "Problem",
    "SurveyDataError",
    "SurveyImportError",
    "SurveyTables",
    "fidelity",
    "import_bibliography",
    "import_table",
    "load",
    "match_columns",
    "plan_import",
    "read_table",
    "validate",
]

_HOMES = {
    "BibliographyPlan": "importing.identities",
    "ColumnMapping": "importing.columns",
    "Difference": "importing.plan",
    "FidelityReport": "findings.report",
    "FindingVerdict": "findings.checks",
    "ImportPlan": "importing.plan",
    "Problem": "problems",
    "SurveyDataError": "problems",
    "SurveyImportError": "problems",
    "SurveyTables": "tables",
    "fidelity": "findings.report",
    "import_bibliography": "importing.identities",
    "import_table": "importing.table_import",
    "load": "tables",
    "match_columns": "importing.columns",
    "plan_import": "importing.plan",
    "read_table": "importing.table_reader",
    "validate": "validation.validate",
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
