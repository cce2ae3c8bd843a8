"""Two findings again from published files: python recompute_findings.py PUBLISHED RESOLUTION.CSV.

With pandas and NumPy alone. RESOLUTION.CSV is the deposit's table of what runs for each study, made
of standard data sets alone.
"""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pandas as pd

CELL = ["dataset", "extractor", "model"]
NOTHING_FITTED = ("spm", "basic", "solar-panel")
published, resolution = Path(sys.argv[1]), pd.read_csv(sys.argv[2])
scores = pd.concat(
    pd.read_csv(file).assign(dataset=file.stem) for file in (published / "scores").glob("*.csv")
)
scores = scores[(scores.condition == "nominal") & scores.rms_all_answers_deg.notna()]
standard = scores[scores.unit == 0].set_index(CELL)
standard = standard[standard.availability >= 0.95].sort_index()
by_unit = scores.pivot_table(index=CELL, columns="unit", values="rms_all_answers_deg")
by_unit = by_unit.loc[by_unit.index.isin(standard.index)]
own = np.exp(np.log(by_unit).mean(axis=1))
pins = pd.read_csv(published / "pins.csv").query("condition == 'nominal' and split == 'test'")
bench = pins.set_index("dataset").bench_deg
best = own.groupby("dataset").idxmin()


def ratio(one, other, bench_one=0.0, bench_other=0.0):
    """Geometric mean over the units that both have."""
    first, second = np.hypot(by_unit.loc[one], bench_one), np.hypot(by_unit.loc[other], bench_other)
    return float(np.exp(np.log(first / second).mean()))


def summary(values):
    """Median, and its 95 % interval by order statistics: binomial tails of 2.5 % at most."""
    v, n, k, tail = sorted(values), len(values), 0, 0.5 ** len(values)
    while tail <= 0.025:
        k += 1
        tail += math.comb(n, k) * 0.5**n
    return [float(np.median(v)), float(v[k - 1]), float(v[n - k]), n]


mapped = resolution[resolution.edition == "survey"]
uses = mapped.merge(standard[["rms_all_answers_deg", "rms_deg"]].reset_index(), on=CELL)
base = uses.model.str.split(" + ", regex=False).str[-1]
stated = ~uses[["extractor_basis", "model_basis"]].isin(["recalled", "defaulted"]).any(axis=1)
lost = [mapped.study.nunique() - uses.study.nunique()]
for keep in (uses.rms_all_answers_deg <= 2 * uses.rms_deg, stated, ~base.isin(NOTHING_FITTED)):
    kept = uses[keep.loc[uses.index]]
    lost.append(uses.study.nunique() - kept.study.nunique())
    uses = kept
uses = uses.assign(cell=list(zip(*(uses[name] for name in CELL), strict=True)))
uses["ratio"] = [ratio(cell, best[cell[0]]) for cell in uses.cell]
nearest = uses.sort_values(["ratio", *CELL]).groupby("study").cell.first()
benches = [ratio(c, best[c[0]], bench[c[0]], bench[c[0]]) for c in set(nearest)]
drawn = [(d, e) for d, e, m in own.index if m == "spm" and (d, e, "pinhole") in own.index]
gain = pd.Series(
    [ratio((*at, "spm"), (*at, "pinhole"), 0.0, bench[at[0]]) for at in drawn],
    pd.MultiIndex.from_tuples(drawn),
)
own_ratios = [ratio(c, best[c[0]]) for c in set(nearest)]
found = {"studies": len(nearest), "lost": lost, "pairs": len(gain)}
found |= {"own": summary(own_ratios), "bench": summary(benches)}
found["constants"] = summary(gain.groupby(level=0).median())
sys.stdout.write(json.dumps(found))
