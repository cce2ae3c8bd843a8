"""The contract of an algorithm: a module that fails is named by file and line, checks by words."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from algorithms import extractors
from api.cli import contract
from api.cli.contract import name_of
from api.cli.wrong_call import WrongCallError


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A module of extractors, still to be written, in another checkout."""
    folder = tmp_path / "algorithms" / "extractors"
    folder.mkdir(parents=True)
    monkeypatch.setattr(contract, "ROOT", tmp_path)
    monkeypatch.setattr(extractors, "__path__", [str(folder)])
    yield folder / "new_idea.py"
    sys.modules.pop("algorithms.extractors.new_idea", None)
    vars(extractors).pop("new_idea", None)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x = 1\ndef f(:\n", r"new_idea\.py, line 2: SyntaxError: "),
        ("import math\n\nmath.sqroot(2)\n", r"^algorithms/extractors/new_idea\.py, line 3: Attrib"),
        (
            "class Half:\n    def extract(self):\n        return 1\n",
            r"^TypeError: .*Half lacks about",
        ),
    ],
)
def test_a_module_that_cannot_be_imported_is_named_with_its_line(
    module: Path, text: str, says: str
) -> None:
    module.write_text(text)
    with pytest.raises(WrongCallError, match=says):
        name_of("direct")
