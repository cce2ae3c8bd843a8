"""Facts about the mapped sun-sensor studies: tables, their validation, fidelity and import.

The data are the CSV files beside this file, described by `datapackage.json`. Importing the
package is cheap: pandas, frictionless and openpyxl load with the first function that needs them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey_data.findings.report import FidelityReport, fidelity
    from survey_data.importing.identities import BibliographyPlan, import_bibliography
    from survey_data.importing.table_import import ImportPlan, import_table
    from survey_data.importing.table_reader import read_table
    from survey_data.problems import Problem, SurveyDataError, SurveyImportError
    from survey_data.tables import SurveyTables, load
    from survey_data.validation.validate import validate

_MODULES = {
    "findings.report": ("FidelityReport", "fidelity"),
    "importing.identities": ("BibliographyPlan", "import_bibliography"),
    "importing.table_import": ("ImportPlan", "import_table"),
    "importing.table_reader": ("read_table",),
    "problems": ("Problem", "SurveyDataError", "SurveyImportError"),
    "tables": ("SurveyTables", "load"),
    "validation.validate": ("validate",),
}
__all__ = [
    "BibliographyPlan",
    "FidelityReport",
    "ImportPlan",
    "Problem",
    "SurveyDataError",
    "SurveyImportError",
    "SurveyTables",
    "fidelity",
    "import_bibliography",
    "import_table",
    "load",
    "read_table",
    "validate",
]


def __getattr__(name: str) -> object:
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
