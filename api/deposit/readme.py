"""README.md of the bundle: what lies in it, how to read and check it, on what terms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from api.deposit.code_archive import FOLDER as CODE
from api.deposit.code_archive import SCRIPT
from api.deposit.database import COLUMNS, DATABASE, TABLES
from api.deposit.frames import FOLDER as FRAMES
from api.metadata.bundled import FOLDER as CROISSANT
from api.metadata.citation import repository, unfilled
from api.metadata.identity import Identity
from files.checksums import CHECKSUMS
from survey_data.editions import editions

BIBLIOGRAPHY = "bibliography"
"""Folder of the references."""

#: Runs in the bundle's directory with NumPy alone; a test runs it.
EXAMPLE = """\
import json
import sqlite3
from pathlib import Path

import numpy as np

# A sensor behind one hole, and what its data set says of itself.
folder = Path("frames/cmos-single-aperture")
card = json.loads((folder / "card.json").read_text("utf-8"))
print(card["name"], card["version"], "-", card["arrays"]["observations"])


def spots(split):
    \"\"\"Centroids (x, y) of the spots in pixels, and unit vectors to where the Sun stood.\"\"\"
    with np.load(folder / "nominal" / f"{split}.npz") as samples:
        # Of the calibration, `sun` is what a bench with errors of its own says; scores are of
        # calibrations with the true directions.
        directions = "true_sun" if "true_sun" in samples else "sun"
        frames, sun, first = (samples[n] for n in ("observations", directions, "origin_px"))
    light = np.clip(frames - np.median(frames, axis=(1, 2), keepdims=True), 0.0, None) ** 2
    y, x = np.indices(light.shape[1:])
    centre = [(light * axis).sum(axis=(1, 2)) / light.sum(axis=(1, 2)) for axis in (x, y)]
    return np.column_stack(centre) + first, sun


def terms(x, y):
    powers = [(i, j) for i in range(4) for j in range(4 - i)]
    return np.column_stack([x**i * y**j for i, j in powers])


# Calibrate: angles tan(beta) = x/z and tan(alpha) = y/z as polynomials of the spot.
seen, sun = spots("calibration")
middle, scale = seen.mean(axis=0), seen.std(axis=0)
fit = np.linalg.lstsq(terms(*((seen - middle) / scale).T), sun[:, :2] / sun[:, 2:], rcond=None)[0]

# Test: the angle between what the fit says and where the Sun stood, as the scores have it.
seen, sun = spots("test")
found = np.column_stack([terms(*((seen - middle) / scale).T) @ fit, np.ones(len(seen))])
found /= np.linalg.norm(found, axis=1, keepdims=True)
across, along = np.linalg.norm(np.cross(found, sun), axis=1), (found * sun).sum(axis=1)
error = np.degrees(np.arctan2(across, along))
print(f"error: {np.sqrt(np.mean(error**2)):.4f} deg over {len(error)} frames")

# What the leaders of this data set reach on the same frames, from the database.
with sqlite3.connect("sun-sensor-atlas.sqlite") as atlas:
    for row in atlas.execute(
        "SELECT rank, extractor, model, rms_deg FROM leaderboard "
        "WHERE dataset = ? AND condition = 'nominal' ORDER BY rank LIMIT 3",
        (card["name"],),
    ):
        print(*row)

# Every data set's samples are read the same way.
for path in sorted(Path("frames").glob("*/*/*.npz")):
    if path.stem != "references":
        with np.load(path) as samples:
            print(path, samples["observations"].shape, samples["observations"].dtype)
"""


def readme(who: Identity, descriptor: Mapping[str, Any]) -> str:
    """Write the bundle's README from its datapackage.json."""
    described = descriptor["resources"]
    tables = "".join(
        f"| `{r['path']}` | {r['title']} | {_cell(r['description'])} |\n"
        for r in described
        if r.get("type") == "table"
    )
    files = [r for r in described if r["path"].startswith(f"{FRAMES}/")]
    sets = len({r["path"].split("/")[1] for r in files})
    size = round(sum(r["bytes"] for r in files) / 1e6)
    return f"""# {who.title} {who.version}

{who.summary}

Released {who.released.isoformat()}.
{_unfilled(who)}
## What lies here

| place | what |
|---|---|
| `survey/`, `benchmark/` | every table as CSV, listed below |
| `benchmark/samples/` | errors of every pipeline sample by sample, and the directions of the \
samples, as Parquet, two files a data set |
| `parquet/` | the same tables as Parquet, one file each |
| `{DATABASE}` | the same tables in one SQLite file, with keys; in it `{TABLES}` and \
`{COLUMNS}` say what each holds |
| `{CODE}/` | the code that made this, as a source distribution |
| `{SCRIPT}` | measures scores again from the samples, with that code |
| `{FRAMES}/<data set>/` | samples of the standard data sets: what a sensor reads, where the Sun \
stood, the Cramer-Rao bound of each sample, flat and dark readings, a picture, a card |
| `survey/extension/` | studies the survey does not map, and confirmations by authors |
| `{BIBLIOGRAPHY}/` | the identified studies as BibTeX and RIS, and those the survey does not map |
| `datapackage.json` | types, units, keys and meaning of every column \
([Data Package v2](https://datapackage.org)) |
| `ro-crate-metadata.json` | every file in the words of schema.org \
([RO-Crate 1.2](https://w3id.org/ro/crate/1.2)) |
| `{CROISSANT}/` | record, facts and each data set as programs for machine learning load them \
([Croissant 1.0](https://docs.mlcommons.org/croissant/)) |
| `CITATION.cff` | how to cite |
| `codemeta.json` | the software in the words of [CodeMeta](https://codemeta.github.io) |
| `{CHECKSUMS}` | SHA-256 of every other file |

## Reading

In this directory, with Python and NumPy:

```python
{EXAMPLE}```

In a browser: `datasette {DATABASE}`.

## Editions

The survey's studies are frozen in `survey/*.csv`; {_extension()}
stand in `survey/extension/` with the same columns. `benchmark/all_studies.csv` has both with
their edition, `benchmark/editions.csv` and `CITATION.cff` the version of each: cite the one that
was used.

## Samples

Public measurements of sun sensors hardly exist; these are simulated, as the cards say. In
`{FRAMES}/` lie {len(files)} files of arrays of {sets} data sets, {size} MB: of each the nominal \
condition,
calibration, test and repeat split (poses held still), whole. Of a calibration, `sun` is what its
bench says and `true_sun` where the Sun stood; scores are of calibrations with the true directions.
Other conditions and other units of each sensor: `sunatlas dataset export`; `benchmark/data.csv` has
their hashes.

## Scores, measured again

```sh
python {SCRIPT} --cells 20 --seed 1
```

Needs Python 3.11 or later and a package registry that pip can reach, nothing else. It installs the
code of `{CODE}/` and what its lock file pins into a virtual environment, draws scores by the seed,
fits and scores them from the samples here, and compares every number with `benchmark/scores.csv` to
its last digit; it says how many of the scores can be measured from these samples. Another
processor or other versions than the pinned ones may change the last digits.

## Tables

An empty cell means that nothing is known; `none stated`, and `None` in the tables of `survey/`,
that a study states no model, extractor or error: pandas reads the latter from CSV with
`keep_default_na=False`, and from Parquet as it is. Cells are written as they are: a spreadsheet may
run one that starts with `=`, `+`, `-` or `@`, as bundles of others may hold.

| file | table | what it holds |
|---|---|---|
{tables}
## Checking

```sh
sha256sum --check {CHECKSUMS}
frictionless validate datapackage.json
rocrate-validator validate --profile-identifier ro-crate-1.2 .
```

## Terms

Facts, in `survey/` and `{BIBLIOGRAPHY}/`: CC BY 4.0 (`survey/LICENSE`). Everything else, which
code measured or made: MIT (`LICENSE`).
"""


def _extension() -> str:
    """Count the studies that the survey does not map, those of its years and later ones."""
    survey, other = editions()
    within = other.studies - other.later
    return (
        f"{other.studies} studies that it does not map ({within} of its years, up to "
        f"{survey.last_year}, and {other.later} after them)"
    )


def _unfilled(who: Identity) -> str:
    """Say what a person has still to fill in; empty where nothing is."""
    lacking = unfilled(who.authors, repository(who.citation))
    if not lacking:
        return ""
    return (
        f"\nNot ready to be archived: {'; '.join(lacking)}. `sunatlas deposit upload` refuses this "
        "bundle until CITATION.cff has them.\n"
    )


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
