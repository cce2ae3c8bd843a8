"""The generated parts of docs/ and of the README: what the code knows, where people read it.

A page holds prose and, between `<!-- generated: NAME -->` and `<!-- end: NAME -->`, parts that are
made here; blocks of the guide's pages are run, and stand with what they print. `python -m
api.docs.documentation` renews all of it; `--check` names the pages that are behind.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from api.docs import (
    assessment,
    boards,
    claim_pages,
    curves,
    dictionary,
    filters,
    front,
    limits,
    measured_facts,
    model_pages,
    words,
)
from api.docs.blocks import rerun
from api.docs.export import export_example
from api.docs.parts import (
    command_line,
    coverage,
    datasets,
    extractors,
    findings,
    http_examples,
    missing_implementations,
    resolutions,
    study_sensors,
)
from api.metadata import codemeta
from api.metadata.identity import identity
from benchmark.processes import call_to_end
from benchmark.progress import console_progress
from benchmark.running.experiment import recorded_experiments
from files.atomic import replace_file, temporary_directory
from files.locks import wait_for_lock

DIRECTORY = Path(__file__).resolve().parents[2] / "docs"

Make = Callable[[], str]
PAGES: Mapping[str, Mapping[str, Make]] = {
    "../README.md": {"findings": front.findings, "tallies": front.tallies},
    "algorithms.md": {
        "extractors": extractors,
        "model-pages": model_pages.index,
        "missing": missing_implementations,
    },
    "datasets.md": {
        "coverage": coverage,
        "example": export_example,
        "datasets": datasets,
        "study-sensors": study_sensors,
    },
    "leaderboard.md": {
        "how-sure": boards.how_sure,
        "architectures": boards.best_per_architecture_table,
        "parts": boards.parts,
    },
    "limits.md": {
        "best-pipelines": limits.best_pipelines,
        "sentences": limits.sentences,
        "headlines": limits.headline_table,
    },
    "learning-curves.md": {
        "counts": curves.counts,
        "needed": curves.poses_needed,
        "unreached": curves.leaders_short_of_poses,
    },
    "sweeps.md": {
        "features": assessment.features,
        "accuracy": assessment.accuracy,
        "faults": assessment.faults,
        "unmeasured": assessment.features_without_measure,
    },
    "assessment.md": {
        "definitions": assessment.definitions,
        "outcomes": assessment.outcomes,
    },
    "claims.md": {
        "counts": claim_pages.counts,
        "verdicts": claim_pages.verdicts,
        "trials": claim_pages.trials,
    },
    "filters.md": {"errors": filters.errors},
    "survey.md": {"findings": findings, "resolutions": resolutions},
    "http.md": {"endpoints": http_examples},
    "command-line.md": {"help": command_line},
    "guide/found.md": {
        "findings": measured_facts.findings,
        "error-budget": measured_facts.error_budget,
        "poses": curves.counts,
        "tallies": measured_facts.tallies,
        "not-reproduced": measured_facts.claims_not_reproduced,
        "useful": measured_facts.reproduced_claims,
    },
    "guide/glossary.md": {"terms": words.terms, "abbreviations": words.abbreviations},
    "guide/data-dictionary.md": {
        "facts": dictionary.facts,
        "measurements": dictionary.measurements,
    },
}
#: Pages whose blocks are run, and what they print renewed.
RUN = tuple(
    f"guide/{page}.md"
    for page in (
        *("tutorial", "calibrate", "scores", "python"),
        *("add-an-algorithm", "add-a-data-set", "add-a-study"),
    )
)

_PART = re.compile(
    r"(?P<opening><!-- generated: (?P<name>[a-z-]+) -->\n)"
    r"(?P<body>.*?)"
    r"(?P<closing><!-- end: (?P=name) -->)",
    re.DOTALL,
)


class DocumentationError(ValueError):
    """A page does not have the parts it should; the message names both."""


def every_page(directory: Path = DIRECTORY) -> Mapping[str, Mapping[str, Make]]:
    """Return what makes the parts of each page, those of the models' categories among them."""
    return {**PAGES, **model_pages.pages(directory)}


def every_picture() -> Mapping[str, Make]:
    """Return what makes each picture, and the one file that is generated whole."""
    return {
        "answer.svg": front.picture,
        f"../{codemeta.NAME}": lambda: codemeta.codemeta_text(identity().citation),
        **model_pages.pictures(),
        **{
            name: draw
            for kind in recorded_experiments().values()
            for name, draw in kind().pictures().items()
        },
    }


def text_of(page: str, directory: Path = DIRECTORY) -> str:
    """Return a page as it is; one of a category that has its first model, as it starts."""
    if page in PAGES:
        return (directory / page).read_text("utf-8")
    return model_pages.text_of(page, directory)


def renew_parts(page: str, text: str, parts: Mapping[str, Make]) -> str:
    """Return a page with its generated parts renewed.

    Parameters
    ----------
    page : its name, for messages
    text : as it is
    parts : what makes each part, by name

    Raises
    ------
    DocumentationError
        Where a part is missing, unknown, or there twice.
    """
    found = [match["name"] for match in _PART.finditer(text)]
    if sorted(found) != sorted(parts):
        raise DocumentationError(
            f"{page}: expected one generated part each of {', '.join(sorted(parts))}; "
            f"found {', '.join(sorted(found)) or 'none'}"
        )
    return _PART.sub(
        lambda match: f"{match['opening']}\n{parts[match['name']]().strip()}\n\n{match['closing']}",
        text,
    )


def _renewed(page: str, parts: Mapping[str, Make], directory: Path) -> str:
    return renew_parts(page, text_of(page, directory), parts)


def _rerun(page: str, directory: Path) -> str:
    with temporary_directory() as scratch:
        return rerun(page, (directory / page).read_text("utf-8"), scratch)


def regenerate(directory: Path = DIRECTORY, *, write: bool = True) -> list[str]:
    """Renew every page and picture; return the names of those that were behind.

    Parameters
    ----------
    directory : where the pages are
    write : write those that were behind

    Raises
    ------
    DocumentationError
        Where a page does not have the parts it should.
    FileNotFoundError
        Where a page is missing.
    """
    made: dict[str, Make] = {
        page: partial(_renewed, page, parts, directory)
        for page, parts in every_page(directory).items()
    }
    made |= {page: partial(_rerun, page, directory) for page in RUN}
    made |= every_picture()
    behind = {}
    with console_progress("documenting") as report:
        for done, (name, make) in enumerate(made.items()):
            report(done, len(made), name)
            path, new = directory / name, make()
            if not path.is_file() or path.read_text("utf-8") != new:
                behind[name] = new
    if write:
        with wait_for_lock(directory / "pages"):
            for page, new in behind.items():
                replace_file(directory / page, new)
    return sorted(behind)


def main(arguments: list[str] | None = None) -> int:
    """Renew the pages, or with --check only say which are behind (exit code 1)."""
    parser = argparse.ArgumentParser(
        prog="python -m api.docs.documentation", description=main.__doc__
    )
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args(arguments)
    behind = regenerate(write=not options.check)
    for page in behind:
        said = "is behind; run `make docs`" if options.check else "renewed"
        sys.stderr.write(f"docs/{page} {said}\n")
    return 1 if behind and options.check else 0


if __name__ == "__main__":
    call_to_end(main)
