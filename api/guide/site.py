"""Where the guide's pages are, and the site that is made of them.

A site is built once for its sources, kept in the user's cache, and never committed. What builds it
(Sphinx, MyST, Furo) is the extra `guide` of the distribution.
"""

from __future__ import annotations

import hashlib
import io
import os
import re
import shutil
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from pathlib import Path
from typing import Any

from api.guide.atlas import atlas_links
from api.guide.chapters import ROOT
from api.user_cache import user_cache
from benchmark.progress import ProgressCallback, silent
from files.atomic import replace_all, require_replaceable, temporary_directory

BUILDERS = ("sphinx", "myst-parser", "furo")
INSTALL = "pip install 'sun-sensor-atlas[guide]'"

#: Sites of so many states of the pages are kept.
KEPT = 4

_PROJECT = "Sun Sensor Atlas"
_UNWRITTEN = re.compile(r"error writing file|cannot copy |Failed to copy ")
_DOCUMENTED = re.compile(r"^\.\. automodule:: (\S+)$", re.MULTILINE)
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_HERE = Path(__file__).resolve().parent
_CHECKOUT = _HERE.parents[1] / "docs"


class GuideError(RuntimeError):
    """The guide cannot be built; the message says why and what to do."""


def source() -> Path:
    """Return the directory of the pages: docs/ of a checkout, else what the wheel carries.

    Raises
    ------
    GuideError
        Where there is neither.
    """
    for directory in (_CHECKOUT, Path(str(files("api"))) / "guide" / "source"):
        if (directory / f"{ROOT}.md").is_file():
            return directory
    raise GuideError(
        f"no pages of the guide: neither {_CHECKOUT} nor the installed package has any"
    )


@cache
def missing_builders() -> tuple[str, ...]:
    """Name the distributions that building needs and that are not installed."""
    missing = []
    for name in BUILDERS:
        try:
            version(name)
        except PackageNotFoundError:
            missing.append(name)
    return tuple(missing)


def documented_modules() -> list[str]:
    """Name the modules whose docstrings are on the page of the Python interface."""
    page = source() / "guide" / "python.md"
    return _DOCUMENTED.findall(page.read_text("utf-8")) if page.is_file() else []


def _file_of(module: str) -> Path:
    path = _HERE.parents[1].joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def digest() -> str:
    """Return what the site depends on as a digest: pages, this code, and what builds it."""
    summed = hashlib.blake2b(digest_size=12)
    for root in (source(), _HERE, _HERE.parent / "mathml.py"):
        for path in sorted(root.rglob("*")) or [root]:
            if path.is_file() and path.suffix in {".md", ".svg", ".png", ".py", ".css"}:
                summed.update(f"\0{path.relative_to(root).as_posix()}\0".encode())
                summed.update(path.read_bytes())
    for module in documented_modules():
        summed.update(f"\0{module}\0".encode() + _file_of(module).read_bytes())
    for name in (*BUILDERS, "latex2mathml"):
        summed.update(f"{name} {version(name)}\n".encode())
    return summed.hexdigest()


def cached_site() -> Path | None:
    """Return where the site of these pages is kept, built or not; None where it cannot be built."""
    return None if missing_builders() else user_cache() / "guide" / digest()


def build(out: Path, progress: ProgressCallback = silent) -> list[str]:
    """Build the site into a directory, which is replaced whole or not at all.

    Parameters
    ----------
    out : of the site; an earlier one there is replaced
    progress : called as ``progress(done, total, what)`` in pages, each read and written

    Returns
    -------
    list of str
        Warnings, each with its page and line; a sound site has none.

    Raises
    ------
    GuideError
        Where what builds it is not installed, it fails, or `out` holds anything but an earlier
        site.
    """
    missing = missing_builders()
    if missing:
        raise GuideError(f"building the guide needs {', '.join(missing)}: {INSTALL}")
    from sphinx.application import Sphinx  # noqa: PLC0415 - an extra, and a second to import
    from sphinx.errors import SphinxError  # noqa: PLC0415

    out = out.resolve()
    require_replaceable(out)
    _require_ours(out)
    log = io.StringIO()
    with temporary_directory() as scratch, replace_all(out) as (made,):
        try:
            sphinx = Sphinx(
                srcdir=source(),
                confdir=None,
                outdir=made,
                doctreedir=scratch,
                buildername="html",
                confoverrides=_settings(),
                status=None,
                warning=log,
                freshenv=True,
            )
            _count(sphinx, progress)
            sphinx.build(force_all=True)
        except SphinxError as error:
            raise GuideError(f"the guide cannot be built: {error}") from error
        (made / ".buildinfo").unlink(missing_ok=True)
        warnings = [w for w in _COLOUR.sub("", log.getvalue()).splitlines() if w.strip()]
        # Sphinx warns of a file that it cannot write, and goes on.
        unwritten = [line for line in warnings if _UNWRITTEN.search(line)]
        if unwritten:
            said = unwritten[0].replace(str(made), str(out))
            raise GuideError(f"the guide cannot be written whole: {said}; nothing was changed")
    return warnings


def _count(sphinx: Any, progress: ProgressCallback) -> None:
    """Let Sphinx tell of each page that it reads and writes."""
    done, total = 0, 0

    def begin(_app: Any, _env: Any, docnames: list[str]) -> None:
        nonlocal total
        total = 2 * len(docnames)

    def step(_app: Any, docname: str, *_: Any) -> None:
        nonlocal done
        done = min(done + 1, total)
        progress(done, total, docname)

    sphinx.connect("env-before-read-docs", begin)
    sphinx.connect("source-read", step)
    sphinx.connect("html-page-context", step)


def _require_ours(out: Path) -> None:
    """Refuse to replace anything but an earlier site."""
    if not out.exists() or (out.is_dir() and not any(out.iterdir())):
        return
    inventory = out / "objects.inv"
    head = inventory.read_bytes()[:200] if inventory.is_file() else b""
    if f"# Project: {_PROJECT}\n".encode() not in head:
        raise GuideError(
            f"{out}: holds something else than an earlier guide; choose an empty directory with "
            "--out; nothing was written"
        )


def keep(progress: ProgressCallback = silent) -> list[str]:
    """Build the site where `cached_site` says, drop the oldest ones.

    Return the warnings as `build`.
    """
    place = cached_site()
    if place is None:
        raise GuideError(f"building the guide needs {', '.join(missing_builders())}: {INSTALL}")
    if place.is_dir():
        return []
    warnings = build(place, progress)
    _drop_oldest(place)
    return warnings


def _drop_oldest(place: Path) -> None:
    """Delete all but the newest sites: checkouts share a cache, and each has its own pages."""
    sites = [path for path in place.parent.iterdir() if not path.name.startswith(".")]
    for old in sorted(sites, key=lambda path: path.stat().st_mtime)[:-KEPT]:
        shutil.rmtree(old, ignore_errors=True)


def _settings() -> dict[str, Any]:
    """Return what Sphinx reads from a conf.py elsewhere."""
    return {
        "project": _PROJECT,
        "html_title": _PROJECT,
        "extensions": [
            *("myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"),
            "api.guide.extension",
        ],
        # Docstrings of the Python interface: names in backquotes are code, types are no links.
        "default_role": "code",
        "autodoc_default_options": {"members": True},
        "autodoc_member_order": "bysource",
        "autodoc_preserve_defaults": True,
        "napoleon_google_docstring": False,
        "nitpick_ignore_regex": [("py:.*", ".*")],
        "root_doc": ROOT,
        "source_suffix": {".md": "markdown"},
        "myst_enable_extensions": ["dollarmath"],
        "myst_heading_anchors": 6,
        "myst_dmath_double_inline": True,
        "smartquotes": False,
        "html_math_renderer": "mathml",
        "html_theme": "furo",
        "html_theme_options": {"announcement": atlas_links()},
        "html_static_path": [os.fspath(_HERE / "static")],
        "html_css_files": ["guide.css"],
        "html_favicon": os.fspath(_HERE.parent / "static" / "icon.svg"),
        "html_copy_source": False,
        "html_domain_indices": False,  # a list of modules beside the search says nothing more
        "html_show_sphinx": False,
        "html_show_copyright": False,
        "html_use_index": False,
        "nitpicky": True,
    }
