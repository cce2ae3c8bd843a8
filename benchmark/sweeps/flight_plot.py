"""Picture of errors along a flight: single samples, and filters of the same readings.

``python -m benchmark.sweeps.flight_plot docs/filters-in-orbit.svg`` draws it anew.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from algorithms.contract import Floats
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.metrics.separation import separation_deg
from benchmark.plan.parts import installed_parts
from benchmark.plot_style import plain_style
from files.atomic import replace_file

if TYPE_CHECKING:
    from algorithms.filtering.sequence import SunFilter

#: Data set, extractor, model of single samples, filter: a panel each.
PANELS = (
    ("pd-orbit", "direct", "sun-and-earth + assembled-faces", "extended-kalman"),
    ("pd-orbit", "direct", "sun-and-earth + assembled-faces", "assembly-drift"),
    ("ccd-orbit", "bctm", "homography", "extended-kalman"),
)
#: Two that every kind of colour vision tells apart (Okabe and Ito), and greys.
_FILTER, _SINGLE, _DARK = "#0072b2", "#d55e00", "#e3e7eb"
_DIGITS = 4
#: From the start that are shown: two eclipses, with what lies between.
_MINUTES = 135.0


def along(dataset: str, extractor: str, single: str, filtered: str) -> dict[str, Floats]:
    """Own errors along the test split under nominal conditions, degrees.

    Returns
    -------
    dict of ndarray, shape (N,)
        ``minutes`` since the start, ``eclipse`` (0 or 1), error of the ``single`` model, of the
        ``filtered`` direction, dead reckoning too, and the filter's own ``deviation``, 1-sigma of
        both axes together.
    """
    parts = installed_parts()
    preset = parts.presets[dataset]
    reader = parts.extractor(extractor).for_sensor(preset.geometry)
    known, test = (preset.generate("nominal", split) for split in ("calibration", "test"))
    by = correction(preset, "nominal")
    features = [features_of(reader, part, by) for part in (known, test)]
    kind = reader.about.kind
    still = parts.model(single).for_sensor(preset.geometry, kind)
    still.fit(features[0], known.truth, known.context)
    model = cast("SunFilter", parts.model(filtered).for_sensor(preset.geometry, kind))
    model.fit(features[0], known.truth, known.context)
    track = model.track(features[1], test.context)
    context: Any = test.context
    eclipse = np.asarray(context["eclipse"], dtype=np.float64)
    alone = separation_deg(still.predict(features[1], test.context), test.sun)
    alone[eclipse > 0] = np.nan  # of the dark nothing can be distinguished from one sample
    return {
        "minutes": (context["time_s"] - context["time_s"][0]) / 60.0,
        "eclipse": eclipse,
        "single": alone,
        "filtered": separation_deg(track.sun, test.sun),
        "deviation": np.sqrt(2.0) * track.deviation_deg,
    }


def picture() -> str:
    """Draw a panel for each of `PANELS` as SVG, eclipses grey; numbers rounded to 1e-4 deg."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    settings: dict[str, Any] = {
        "svg.hashsalt": "sun-sensor-atlas",
        "svg.fonttype": "none",
        "font.family": "sans-serif",
        "path.simplify": True,
    }
    with plain_style(**settings):
        figure = Figure(figsize=(9.0, 2.6 * len(PANELS)), layout="constrained")
        for axes, panel in zip(figure.subplots(len(PANELS), 1), PANELS, strict=True):
            dataset, _, single, filtered = panel
            found = {name: np.round(column, _DIGITS) for name, column in along(*panel).items()}
            shown = found["minutes"] <= _MINUTES
            found = {name: column[shown] for name, column in found.items()}
            minutes = found["minutes"]
            axes.fill_between(
                minutes, 0, 1, where=found["eclipse"] > 0, color=_DARK, lw=0,
                transform=axes.get_xaxis_transform(),
            )  # fmt: skip
            axes.plot(minutes, found["single"], ".", ms=2, color=_SINGLE, label=single)
            axes.plot(minutes, found["filtered"], "-", lw=1, color=_FILTER, label=filtered)
            axes.plot(
                minutes, found["deviation"], "--", lw=0.8, color="black", label="1-sigma it states"
            )
            axes.set_yscale("log")
            axes.set_ylabel("error, deg")
            axes.set_title(f"{dataset}, nominal", loc="left", fontsize=10)
            axes.legend(loc="upper left", fontsize=7)
            axes.set_xlim(minutes[0], minutes[-1])
        axes.set_xlabel("minutes of the test split (grey: eclipse, dead reckoning)")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


if __name__ == "__main__":
    replace_file(Path(sys.argv[1]), picture())
