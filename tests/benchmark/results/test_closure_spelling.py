"""How the syntax trees are spelt that digests of code are taken of."""

import hashlib
import importlib

from benchmark.results.analyses import Analyses
from benchmark.results.closure import Sources

SOURCE = "from math import sin\n\nHALF = 0.5\n\ndef work():\n    return sin(HALF)\n"


def short(text):
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def test_digests_of_records_are_of_syntax_trees_spelt_alike_for_good(tmp_path, monkeypatch):
    """Spelt here by hand: were it done otherwise, no record kept so far would fit its code."""
    (tmp_path / "spelt_pkg").mkdir()
    (tmp_path / "spelt_pkg" / "__init__.py").touch()
    (tmp_path / "spelt_pkg" / "top.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    half = "(Assign targets=[(Name id=str:'HALF'),] value=(Constant value=float:0.5))"
    sine = "(Call func=(Name id=str:'sin') args=[(Name id=str:'HALF'),])"
    work = f"(FunctionDef name=str:'work' args=(arguments) body=[(Return value={sine}),])"
    lines = [
        f"spelt_pkg.top:HALF {short(half)}",
        "spelt_pkg.top:sin math.sin",
        f"spelt_pkg.top:work {short(work)}",
    ]
    assert Sources(Analyses()).digest("spelt_pkg.top:HALF") == short(lines[0])
    assert Sources(Analyses()).digest("spelt_pkg.top:work") == short("\n".join(lines))
