"""The compiled loops where nothing can be cached."""

from __future__ import annotations

import ast
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import caching

import algorithms
from algorithms.compiled import compiled

ROOT = Path(algorithms.__file__).parent.parent


CENTRES = """
import numpy as np
from algorithms.extractors.frames.multi_spot.weighted_spots import WeightedSpots
holes = ((-8, -6, 5), (8, -5, 5), (-7, 7, 5), (9, 6, 5))
y, x = np.mgrid[:40, :46]
away = np.array([np.hypot(x - 23.4 - u, y - 18.8 - v) for u, v, _ in holes])
light = 20 + 200 * np.clip(3.0 - away, 0, 1).sum(axis=0)
frame = np.round(light + np.random.default_rng(1).normal(0, 2, light.shape)).astype(np.uint16)
print(*(value.hex() for value in WeightedSpots(holes).extract(frame[None])[0].tolist()))
"""


def test_kernels_give_the_same_numbers_without_the_compiler():
    """For debuggers and coverage: Numba then hands the functions back as they are."""
    found = [
        subprocess.run(
            [sys.executable, "-c", CENTRES],
            env={**os.environ, "NUMBA_DISABLE_JIT": disabled},
            check=True,
            capture_output=True,
            text=True,
            cwd=ROOT,
            timeout=600,
        ).stdout
        for disabled in ("0", "1")
    ]
    assert len(found[0].split()) == 2
    assert "nan" not in found[0]
    assert found[0] == found[1]


@pytest.mark.slow
def test_a_change_in_a_kernel_of_another_file_is_noticed(tmp_path):
    """The caller's machine code has the callee's inside, and Numba looks at the caller's alone."""
    (tmp_path / "caller.py").write_text(
        "from callee import inner\n"
        "from algorithms.compiled import compiled\n"
        "@compiled\n"
        "def outer(x):\n"
        "    return inner(x) + 1.0\n"
    )
    for factor in (2.0, 30.0):
        (tmp_path / "callee.py").write_text(
            "from algorithms.compiled import compiled\n"
            "@compiled\n"
            "def inner(x):\n"
            f"    return {factor} * x\n"
        )
        for _ in range(2):  # compiled, and then read from disk
            code = "from caller import outer; print(outer(1.0), outer.stats.cache_hits)"
            done = subprocess.run(
                [sys.executable, "-c", code],
                env={**os.environ, "PYTHONPATH": f"{tmp_path}:{ROOT}", "PYTHONHASHSEED": "0"},
                check=True,
                capture_output=True,
                text=True,
                timeout=600,
            )
            assert done.stdout.split()[0] == str(factor + 1.0)
        assert "Counter()" not in done.stdout


def test_a_kernel_that_no_place_is_writable_for_is_compiled_all_the_same(tmp_path, monkeypatch):
    (tmp_path / "frozen.py").write_text("def twice(x):\n    return 2 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    twice = importlib.import_module("frozen").twice
    assert compiled(twice)(21) == 42


def test_no_compiled_record_outlives_its_array():
    """Numba frees an array after its last use, whoever still has a record of it."""
    wrong = []
    for floor in ("algorithms", "benchmark"):
        for path in (ROOT / floor).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.FunctionDef) and "compiled" in map(
                    _name, node.decorator_list
                ):
                    wrong += [f"{path}:{one.lineno}" for one in ast.walk(node) if _fleeting(one)]
    assert wrong == []


def _name(node):
    return getattr(node, "id", "")


def _fleeting(node):
    """Whether a record is taken out of an array that nothing else holds."""
    if not (isinstance(node, ast.Subscript) and isinstance(node.value, ast.Call)):
        return False
    call = node.value.func
    return isinstance(call, ast.Attribute) and call.attr in ("empty", "zeros", "ones", "full")
