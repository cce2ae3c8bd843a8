"""The page of the Python interface tells what there is, whatever has been loaded."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

import survey_data
from api.guide.python_page import interface


def test_what_a_package_loads_with_its_first_use_is_on_the_page() -> None:
    told = {
        head.rpartition(".")[2] for head in re.findall(r"^#### (\S+)$", interface(), re.MULTILINE)
    }
    assert set(survey_data.__all__) - told == set()


@pytest.mark.slow
def test_the_page_is_the_same_in_a_process_that_has_loaded_nothing_else() -> None:
    command = "from api.guide.python_page import interface; print(interface(), end='')"
    fresh = subprocess.run(
        [sys.executable, "-c", command], capture_output=True, text=True, check=True
    )
    assert fresh.stdout == interface()
