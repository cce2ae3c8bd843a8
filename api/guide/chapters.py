"""The guide's chapters, in the order in which they are read."""

from __future__ import annotations

from pathlib import Path

ROOT = "index"

_HERE = Path(__file__).resolve().parent


def _decisions() -> tuple[str, ...]:
    """Return the pages of decisions, their list first: of a checkout, else of the wheel."""
    for docs in (_HERE.parents[1] / "docs", _HERE / "source"):
        names = sorted(path.stem for path in docs.glob("decisions/*.md"))
        if names:
            return tuple(f"decisions/{name}" for name in names)  # README: capitals sort first
    return ()


#: Caption of the sidebar, and its pages in docs/ without their suffix.
CHAPTERS: dict[str, tuple[str, ...]] = {
    "Start": ("guide/found", "guide/tutorial", "guide/calibrate", "guide/glossary"),
    "Results": (
        "leaderboard",
        "guide/scores",
        "limits",
        "learning-curves",
        "claims",
        "sweeps",
        "assessment",
        "networks",
        "coded-masks",
    ),
    "Methods": (
        "algorithms",
        "models/lut",
        "models/non-physical",
        "models/geometric",
        "models/physics-informed",
        "models/multiplex",
        "models/neural-network",
        "filters",
    ),
    "Data": ("datasets", "survey", "guide/data-dictionary", "nomenclature"),
    "Interfaces": ("http", "guide/python", "command-line", "deposit"),
    "Adding to it": (
        "guide/add-an-algorithm",
        "guide/add-a-data-set",
        "guide/add-a-study",
        "architecture",
    ),
    "Decisions": _decisions(),
}


def toctrees() -> str:
    """Return the chapters as MyST takes them: a hidden table of contents each."""
    return "\n".join(
        f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"
        for caption, pages in CHAPTERS.items()
    )
