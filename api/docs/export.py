"""The docs' example of an export, run each time the docs are made: what stands there works."""

from __future__ import annotations

import subprocess
import sys

from typer.testing import CliRunner

from api.cli.command_line import app
from files.atomic import temporary_directory

EXPORTS = (
    "dataset export pd-maskless-cube --out cube --condition nominal --split test",
    "dataset export cmos-single-aperture --out frames --condition nominal --split test --n 100",
)
READING = """\
import json

import numpy as np
import pandas as pd

# Currents as a table, one row a sample: the Sun where opposite faces differ.
table = pd.read_csv("cube/nominal/test.csv")
currents = table.filter(like="signal_").to_numpy()
sun = table[["sun_x", "sun_y", "sun_z"]].to_numpy()
found = currents[:, 0::2] - currents[:, 1::2]
found /= np.linalg.norm(found, axis=1, keepdims=True)
error = np.degrees(np.arccos(np.clip((found * sun).sum(axis=1), -1, 1)))
print(f"{len(table)} samples: median error {np.median(error):.2f} deg,", end=" ")
print(f"median bound {table.bound_deg.median():.3f} deg")

# Frames as arrays, windows of a larger detector: the brightest pixel as an angle.
with open("frames/card.json", encoding="utf-8") as file:
    geometry = json.load(file)["geometry"]
with np.load("frames/nominal/test.npz") as arrays:
    frames, sun, origin = arrays["observations"], arrays["sun"], arrays["origin_px"]
row, column = np.unravel_index(frames.reshape(len(frames), -1).argmax(axis=1), frames.shape[1:])
spot = np.stack([column, row], axis=1) + origin - geometry["centre_px"]
angle = np.degrees(np.arctan(spot * geometry["pixel_pitch_mm"] / geometry["focal_length_mm"]))
truth = np.degrees(np.arctan(sun[:, :2] / sun[:, 2:]))
print(f"{len(frames)} frames of {frames.shape[1:]} px: median error in beta and alpha", end=" ")
print(np.median(np.abs(angle - truth), axis=0).round(1), "deg")
"""


def export_example() -> str:
    """Export, read the files with nothing but NumPy and pandas, and show what is printed."""
    with temporary_directory() as directory:
        for command in EXPORTS:
            name, kind, *rest = command.split()
            place = rest.index("--out") + 1
            rest[place] = str(directory / rest[place])
            made = CliRunner().invoke(app, [name, kind, *rest])
            if made.exit_code:
                raise RuntimeError(f"sunatlas {command} failed: {made.stderr}")
        run = subprocess.run(  # noqa: S603 - our own text
            [sys.executable, "-W", "error", "-c", READING],
            cwd=directory,
            capture_output=True,
            text=True,
            check=False,
        )
    if run.returncode:
        raise RuntimeError(f"the example of the docs fails: {run.stderr}")
    commands = "\n".join(f"sunatlas {command}" for command in EXPORTS)
    return f"```sh\n{commands}\n```\n\n```python\n{READING}```\n\n```text\n{run.stdout}```"
