"""Parts of the guide's pages that are made when the guide is built: what the code knows.

A page has `<!-- built: NAME -->` where a part belongs. Pages of the service that say the same are
linked instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from typer.testing import CliRunner

from api.addresses import algorithm_page
from api.cli.asking import knowledge
from api.cli.command_line import COMMANDS, app, load
from api.pages.methods import docstring_parts
from benchmark.assessment.definitions import DEFINITIONS
from benchmark.leaderboard.headlines import Headline, headlines
from survey_data.descriptor import descriptor


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table in Markdown; cells are one line each."""
    lines = [header, ["---"] * len(header), *rows]
    cells = ([" ".join(cell.split()).replace("|", "\\|") for cell in line] for line in lines)
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


def command_line() -> str:
    """Return the help of `sunatlas` and of every command below it."""
    shown = [["--help"]]
    for name in COMMANDS:
        shown.append([name, "--help"])
        shown += [[name, below, "--help"] for below in getattr(load(name), "commands", {})]
    runner = CliRunner(env={"COLUMNS": "88", "TERMINAL_WIDTH": "88"})
    parts = []
    for words in shown:
        text = runner.invoke(app, words, prog_name="sunatlas").stdout.strip()
        title = " ".join(["sunatlas", *words[:-1]])
        parts.append(f"### {title}\n\n```text\n{text}\n```")
    return "\n\n".join(parts)


def tables_of_facts() -> str:
    """Describe the survey's tables, from their descriptor."""
    return "\n\n".join(map(_described, descriptor()["resources"]))


def models() -> str:
    """List the calibration models by category, each with the equations of its docstring."""
    known = knowledge()
    listed: dict[str, list[str]] = {}
    for one in known.catalogue.implementations("model"):
        if " + " in one.name:  # a chain: its parts are listed
            continue
        (said,) = docstring_parts(known.catalogue.model(one.name))
        equations = "".join(f"<p>{text}</p>" for text in said.equations)
        link = f'<a href="{algorithm_page(one.name)}">{one.title}</a>'
        listed.setdefault(one.category, []).append(
            f"<p><strong>{link}</strong> (<code>{one.name}</code>): {one.summary}</p>{equations}"
        )
    return "\n\n".join(f"### {name}\n\n" + "\n\n".join(found) for name, found in listed.items())


def published_figures() -> str:
    """Set every accuracy and precision that a study publishes beside ours, the worst first."""
    known = knowledge()
    every = headlines(known.measurements.score_of, known.facts.studies.values(), known.resolutions)
    header = ("study", "quantity", "published, deg", "ours, deg", "ratio", "pipeline", "difference")
    return table(header, map(_headline, every))


def definitions() -> str:
    """List every property of the assessment with its experiment and limits."""
    header = ("property", "measured as (or why not)", "score", "why it is not judged elsewhere")
    every = DEFINITIONS.values()
    return table(header, ((d.name, d.measure, d.limits() or "not judged", d.why) for d in every))


#: What makes each part, by its name.
PARTS: Mapping[str, Callable[[], str]] = {
    "command-line": command_line,
    "facts": tables_of_facts,
    "models": models,
    "published-figures": published_figures,
    "definitions": definitions,
}


def _described(resource: Mapping[str, Any]) -> str:
    """Describe a table and its columns."""
    schema = resource["schema"]
    lines = [
        f"- `{one['name']}` ({one.get('type', 'any')}): {one.get('description', '')}"
        for one in schema["fields"]
    ]
    keys = schema.get("primaryKey", ())
    key = f" Key: {', '.join([keys] if isinstance(keys, str) else keys)}." if keys else ""
    said = f"{resource['title']}: `{resource['path']}`. {resource['description']}{key}"
    return "\n\n".join((f"### {resource['name']}", said, "\n".join(lines)))


def _headline(one: Headline) -> tuple[str, ...]:
    published = (one.study, f"{one.published.quantity}, {one.published.statistic.name}")
    stated = f"{one.published.value_deg:.2g}"
    if one.place is None or one.our_deg is None or one.ratio is None:
        return (*published, stated, "not measured", "–", "–", one.difference)
    dataset, condition, extractor, model = one.place
    place = f"{extractor} + {model} on `{dataset}`, {condition}"
    ours = (f"{one.our_deg:.2g} ({one.our_statistic})", f"{one.ratio:.2g}")
    return (*published, stated, *ours, place, one.difference)
