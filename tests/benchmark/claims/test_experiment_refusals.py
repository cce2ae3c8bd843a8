"""Modules among the experiments that measure no claim, or one that another measures."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from benchmark.claims import experiments
from benchmark.claims.experiment import ExperimentError, Sketch, find_experiments

WHOLE = (
    '"""What it measures."""\nfrom benchmark.claims.experiment import Trial\n\n'
    "def trial(number):\n    return Trial({'a': 1.0 * number})\n"
)


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """Return a function that writes modules of one folder: the only experiments there are."""
    folder = tmp_path / "madeup"
    folder.mkdir()
    (folder / "__init__.py").touch()
    monkeypatch.setattr(experiments, "__path__", [str(tmp_path)])

    def written(**modules: str) -> None:
        for name, text in modules.items():
            (folder / f"{name}.py").write_text(text)

    yield written
    for name in [name for name in sys.modules if name.startswith(f"{experiments.__name__}.madeup")]:
        del sys.modules[name]
    vars(experiments).pop("madeup", None)


def test_modules_are_found_by_their_claims_and_what_they_share_is_none(
    write: Callable[..., None],
) -> None:
    write(c02_second=WHOLE, c01_first=WHOLE, shared="VALUE = 1\n")
    found = find_experiments.__wrapped__()
    assert list(found) == ["C01", "C02"]
    assert found["C01"].module == "benchmark.claims.experiments.madeup.c01_first"
    assert found["C01"].trial(3).values == {"a": 3.0}
    assert (found["C01"].about, found["C01"].sketch) == ("What it measures.", Sketch())


@pytest.mark.parametrize(
    ("modules", "said"),
    [
        ({"c01_one": WHOLE, "c01_two": WHOLE}, r"C01 has two: .*\.c01_one and .*\.c01_two"),
        ({"c01_one": '"""About."""\n'}, r"madeup\.c01_one must define trial\(number\)"),
        ({"c01_one": '"""About."""\ntrial = 5\n'}, r"madeup\.c01_one must define trial\(number\)"),
        ({"c01_one": WHOLE.partition("\n")[2]}, r"madeup\.c01_one must say in a docstring"),
    ],
)
def test_what_is_no_experiment_is_refused_by_its_module(
    write: Callable[..., None], modules: dict[str, str], said: str
) -> None:
    write(**modules)
    with pytest.raises(ExperimentError, match=said):
        find_experiments.__wrapped__()
