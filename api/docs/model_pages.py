"""A page a category of calibration models: its models by discovery, their numbers, an example.

The prose of a page is written by hand in `docs/models/`. A category that gets its first model has
a page from the next renewal on: it starts from `starts/<category>.md` beside this module where
there is one, else from a bare frame, and is written on by hand from there.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from functools import cache, partial
from pathlib import Path
from typing import Any

from algorithms.display_names import display_name
from api.docs import field_plots
from api.docs.field_plots import PlottedPipeline
from api.docs.knowledge import knowledge
from api.docs.markdown import table
from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.summaries import digits
from benchmark.metrics.score import AVAILABLE
from benchmark.results.store import Store

DIRECTORY = Path(__file__).resolve().parents[2] / "docs"
_STARTS = Path(__file__).with_name("starts")

#: Whose residuals a category's page shows; of others, the pipeline nearest its bound.
SHOWN: Mapping[str, PlottedPipeline] = {
    "LUT": PlottedPipeline("ccd-single-aperture", "energy-filter", "lut"),
    "Non-Physical": PlottedPipeline("qpd-single-aperture", "voltage-balance", "polynomial-2d"),
    "Geometric": PlottedPipeline("ccd-slit", "eigen-analysis", "slit"),
    "Physics-Informed": PlottedPipeline("pd-maskless-pyramid", "direct", "assembled-faces"),
    "Multiplex": PlottedPipeline("pd-code-dial", "dial-tracks", "periodic"),
}

_FRAME = """\
# {title} models

<!-- generated: models -->
<!-- end: models -->

## When to use them

<!-- generated: measured -->
<!-- end: measured -->

## Remaining errors over the field

<!-- generated: picture -->
<!-- end: picture -->
"""
_PYTHON = re.compile(r"^```python\n(?P<code>.*?)^```$", re.DOTALL | re.MULTILINE)


def pages(directory: Path = DIRECTORY) -> dict[str, dict[str, Callable[[], str]]]:
    """Return what makes each part of every category's page, by the page's name."""
    found = {}
    for category in categories():
        page = page_of(category)
        makes: dict[str, Callable[[], str]] = {
            "models": partial(models, category),
            "measured": partial(measure, category),
            "picture": partial(picture, category),
        }
        if any(" + " in model.name for model in _of(category)):
            makes["gains"] = partial(gains, category)
        if _PYTHON.search(text_of(page, directory)):
            makes["output"] = partial(output, page, directory)
        found[page] = makes
    return found


def pictures() -> dict[str, Callable[[], str]]:
    """Return what draws each category's picture, by the file's name."""
    shown = {category: _show(category) for category in categories()}
    return {
        _picture_of(category): partial(field_plots.picture, one)
        for category, one in shown.items()
        if one is not None
    }


def text_of(page: str, directory: Path = DIRECTORY) -> str:
    """Return a page as it is, or as it starts."""
    path = directory / page
    if path.is_file():
        return path.read_text("utf-8")
    start = _STARTS / path.name
    if start.is_file():
        return start.read_text("utf-8")
    title = path.stem.replace("-", " ").capitalize()
    return _FRAME.format(title=title)


def page_of(category: str) -> str:
    """Name the page of a category of the taxonomy."""
    return f"models/{_slug(category)}.md"


@cache
def categories() -> tuple[str, ...]:
    """Return the categories that have an implementation, in the taxonomy's order."""
    known = knowledge()
    order = [known.taxonomy.category("model", v) for v in known.taxonomy.values("model")]
    there = {_category(i.taxonomy) for i in known.catalogue.implementations("model")} - {
        None,
        "None",
    }
    return tuple(category for category in dict.fromkeys(order) if category in there)


def models(category: str) -> str:
    """List a category's models; chains by the compensation ahead of their models."""
    rows: dict[tuple[str, ...], dict[str, None]] = {}
    chains: dict[tuple[str, ...], list[str]] = {}
    for one in _of(category):
        *ahead, _ = one.name.split(" + ")
        summary = one.summary.rpartition(" Then ")[0] if ahead else one.summary
        name = " + ".join(ahead) if ahead else one.name
        row = (
            f"`{name}`",
            display_name(name),
            knowledge().taxonomy.name("model", one.taxonomy),
            summary,
        )
        rows.setdefault(row, {}).update(dict.fromkeys(one.studies))
        chains.setdefault(row, []).append(f"`{one.name}`")
    return table(
        ("identifier", "name", "model of the survey", "what it does", "studies", "scored as"),
        [
            (*row, ", ".join(studies), ", ".join(chains[row]) if " + " in chains[row][0] else "")
            for row, studies in rows.items()
        ],
    )


def measure(category: str) -> str:
    """Say how near their bounds a category's models come, each where it comes nearest."""
    best: dict[str, list[Mapping[str, Any]]] = {i.name: [] for i in _of(category)}
    for row in _board():
        if (
            row["model"] in best
            and row["over_bound"] is not None
            and row["availability"] >= AVAILABLE
        ):
            best[row["model"]].append(row)
    rows = []
    for name, scored in best.items():
        if not scored:
            rows.append((f"`{name}`", "0", *["–"] * 5))
            continue
        nearest = min(scored, key=lambda row: row["over_bound"])
        rows.append(
            (
                f"`{name}`",
                str(len({row["dataset"] for row in scored})),
                str(len({row["dataset"] for row in scored if row["rank"] == 1})),
                nearest["dataset"],
                nearest["extractor"],
                digits(nearest["own_deg"]),
                digits(nearest["over_bound"]),
            )
        )
    header = ("model", "data sets", "first on", "nearest its bound on", "behind")
    said = (
        "Under the first condition of each data set, with the best extractor for each model; "
        f"pipelines with less than {AVAILABLE:.0%} availability are left out."
    )
    return f"{said}\n\n" + table((*header, "own error (deg)", "unit 0 / bound"), rows)


def gains(category: str) -> str:
    """Set every chain beside its model alone, on the same data sets behind the same extractors."""
    errors = {
        (row["model"], row["dataset"], row["extractor"]): row["own_deg"]
        for row in _board()
        if row["own_deg"] is not None and row["availability"] >= AVAILABLE
    }
    rows = []
    for name in (model.name for model in _of(category) if " + " in model.name):
        alone = name.rpartition(" + ")[2]
        pairs = [
            (errors[alone, *where] / error, *where, errors[alone, *where], error)
            for (model, *where), error in errors.items()
            if model == name and (alone, *where) in errors
        ]
        if not pairs:
            rows.append((f"`{name}`", "0", *["–"] * 4))
            continue
        factor, dataset, extractor, before, after = max(pairs)
        rows.append(
            (
                f"`{name}`",
                str(len({where for _, where, *_ in pairs})),
                f"{factor:.3g}",
                f"{digits(before)} to {digits(after)}",
                f"{dataset}, {extractor}",
                f"{min(pairs)[0]:.3g} ({min(pairs)[1]})",
            )
        )
    header = ("chain", "data sets", "at best better by", "own error (deg)", "there", "at worst")
    return table(header, rows)


def picture(category: str) -> str:
    """Show the residuals of one pipeline over the field, with what they come to."""
    shown = _show(category)
    if shown is None:
        return "Nothing is published yet."
    errors = field_plots.rms_deg(shown)
    said = f"`{shown.extractor} + {shown.model}` on `{shown.dataset}`, RMS of unit 0: "
    said += f"{errors['as_is']:.2g} deg as published"
    if "perfect" in errors:
        said += f", {errors['perfect']:.2g} deg with calibration, unit and readings perfect"
        said += " ([explanation](../limits.md#what-is-made-perfect))"
    name = Path(_picture_of(category)).name
    return f"![Residuals over the field]({name})\n\n{said}."


def output(page: str, directory: Path = DIRECTORY) -> str:
    """Run the example of a page, and show what it prints."""
    code = "\n".join(found["code"] for found in _PYTHON.finditer(text_of(page, directory)))
    said = io.StringIO()
    try:
        with redirect_stdout(said), warnings.catch_warnings():
            warnings.simplefilter("error")
            exec(compile(code, page, "exec"), {})  # noqa: S102 - our own text, here to be quick
    except Exception as error:
        raise RuntimeError(f"the example of {page} fails: {error!r}") from error
    return f"```text\n{said.getvalue()}```"


def index() -> str:
    """List the pages with their models."""
    rows = [
        (f"[{category}]({page_of(category)})", ", ".join(f"`{i.name}`" for i in _of(category)))
        for category in categories()
    ]
    return table(("category", "models"), rows)


def _of(category: str) -> list[Any]:
    listing = knowledge().catalogue.implementations("model")
    return [i for i in listing if _category(i.taxonomy) == category]


def _category(value: str) -> str | None:
    return knowledge().taxonomy.category("model", value)


def _show(category: str) -> PlottedPipeline | None:
    if category in SHOWN:
        return SHOWN[category]
    names = {i.name for i in _of(category)}
    scored = [row for row in _board() if row["model"] in names and row["over_bound"] is not None]
    if not scored:
        return None
    nearest = min(scored, key=lambda row: row["over_bound"])
    return PlottedPipeline(nearest["dataset"], nearest["extractor"], nearest["model"])


@cache
def _board() -> list[Mapping[str, Any]]:
    """Return every row under the first condition of its data set, ranked."""
    return [
        row
        for dataset in board_of(Store())["datasets"]
        for row in dataset["rows"]
        if row["condition"] == dataset["conditions"][0]
    ]


def _picture_of(category: str) -> str:
    return f"models/{_slug(category)}.svg"


def _slug(category: str) -> str:
    return "-".join(re.findall(r"[a-z0-9]+", category.lower()))
