"""Where the guide's pages are, and the site that is made of them.

A site is built once for its sources, kept in the user's cache, and never committed. What builds it
(Sphinx, MyST, Furo) is the extra `guide` of the distribution; `api.docs.extension` adds what the
code knows.
"""

from __future__ import annotations

import hashlib
import io
import os
import re
import shutil
from functools import cache
from importlib.metadata import distributions, version
from pathlib import Path
from typing import Any

from api.user_cache import user_cache
from benchmark.progress import ProgressCallback, silent
from files.atomic import replace_all, require_replaceable, temporary_directory

BUILDERS = ("sphinx", "myst-parser", "furo", "latex2mathml")
INSTALL = "pip install 'sun-sensor-atlas[guide]'"

#: Sites of so many states of the pages are kept.
KEPT = 4

_PROJECT = "Sun Sensor Atlas"
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_HERE = Path(__file__).resolve().parent
_ROOT = _HERE.parents[1]
#: What the guide has of the pages: icon, head, and the choice of a colour scheme.
_SHARED = tuple(
    _HERE.parent / "static" / name for name in ("icon.svg", "styles/masthead.css", "theme.js")
)
#: Packages whose code and data pages are made of.
_PACKAGES = ("algorithms", "api", "benchmark", "calibrate", "registry", "survey_data")


class GuideError(RuntimeError):
    """The guide cannot be built; the message says why and what to do."""


def source() -> Path:
    """Return the directory of the pages: docs/ of a checkout, else what the wheel carries.

    GuideError where there is neither.
    """
    for directory in (_ROOT / "docs", _HERE / "source"):
        if (directory / "index.md").is_file():
            return directory
    raise GuideError(
        f"no pages of the guide: neither {_ROOT / 'docs'} nor the installed package has any"
    )


@cache
def missing_builders() -> tuple[str, ...]:
    """Name the distributions that building needs and that are not installed."""
    installed = {one.metadata["Name"].lower() for one in distributions()}
    return tuple(name for name in BUILDERS if name not in installed)


@cache
def digest() -> str:
    """Return what the site depends on as a digest: pages, code, record, and what builds it."""
    summed = hashlib.blake2b(digest_size=12)
    found = [*source().rglob("*"), source().parent / "README.md", *_SHARED]
    found += [*(_HERE / "static").iterdir(), *(_HERE / "templates").rglob("*")]
    found += [_HERE.parent / "pages" / "templates" / "masthead.html"]
    for name in _PACKAGES:
        found += [*(_ROOT / name).rglob("*.py"), *(_ROOT / name).rglob("checksums-sha256.txt")]
    for path in sorted(found):
        if path.is_file():
            summed.update(f"\0{path.name}\0".encode() + path.read_bytes())
    for name in BUILDERS:
        summed.update(f"{name} {version(name)}\n".encode())
    return summed.hexdigest()


def cached_site() -> Path | None:
    """Return where the site of these pages is kept, built or not; None where it cannot be built."""
    return None if missing_builders() else user_cache() / "guide" / digest()


def build(out: Path, progress: ProgressCallback = silent) -> list[str]:
    """Build the site into a directory, which is replaced whole or not at all; return warnings.

    Parameters
    ----------
    out : of the site; an earlier one there is replaced
    progress : called as ``progress(done, total, what)`` in pages, each read and written

    Raises
    ------
    GuideError
        Where what builds it is not installed, it fails, or `out` holds anything but an earlier
        site.
    UnreplaceableError
        Where `out` is the root of a file system.
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
        # A copy: a page a module of Python is written beside the pages, which may be read-only.
        shutil.copytree(source(), scratch / "docs")
        if (readme := source().parent / "README.md").is_file():
            shutil.copy(readme, scratch)
        try:
            sphinx = Sphinx(
                srcdir=scratch / "docs",
                confdir=None,
                outdir=made,
                doctreedir=scratch / "doctrees",
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
    return [w for w in _COLOUR.sub("", log.getvalue()).splitlines() if w.strip()]


def keep(progress: ProgressCallback = silent) -> list[str]:
    """Build the site where `cached_site` says, drop the oldest ones; warnings as `build`."""
    place = cached_site()
    if place is None:
        raise GuideError(f"building the guide needs {', '.join(missing_builders())}: {INSTALL}")
    if place.is_dir():
        return []
    warnings = build(place, progress)
    # Checkouts share a cache, and each has its own pages.
    sites = [path for path in place.parent.iterdir() if not path.name.startswith(".")]
    for old in sorted(sites, key=lambda path: path.stat().st_mtime)[:-KEPT]:
        shutil.rmtree(old, ignore_errors=True)
    return warnings


def _count(sphinx: Any, progress: ProgressCallback) -> None:
    """Let Sphinx tell of each page that it reads and writes."""
    seen: list[str] = []

    def step(_app: Any, page: str, *_: Any) -> None:
        total = 2 * len(sphinx.env.found_docs)
        seen.append(page)
        progress(min(len(seen), total), total, page)

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


def _settings() -> dict[str, Any]:
    """Return what Sphinx reads from a conf.py elsewhere."""
    return {
        "project": _PROJECT,
        "html_title": _PROJECT,
        "extensions": [
            *("myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary"),
            "sphinx.ext.napoleon",
            "api.docs.extension",
        ],
        # Docstrings of the Python interface: names in backquotes are code, types are no links.
        "default_role": "code",
        "autodoc_default_options": {"members": True},
        "autodoc_member_order": "bysource",
        "autodoc_preserve_defaults": True,
        "templates_path": [os.fspath(_HERE / "templates")],
        "napoleon_google_docstring": False,
        "nitpick_ignore_regex": [("py:.*", ".*")],
        "myst_enable_extensions": ["dollarmath"],
        "myst_heading_anchors": 6,
        "myst_dmath_double_inline": True,
        "smartquotes": False,
        "html_math_renderer": "mathml",
        "html_theme": "furo",
        "html_static_path": [os.fspath(place) for place in (_HERE / "static", *_SHARED)],
        "html_css_files": ["masthead.css", "guide.css"],
        "html_js_files": ["theme.js"],
        "html_favicon": os.fspath(_SHARED[0]),
        "html_copy_source": False,
        "html_domain_indices": False,  # a list of modules beside the search says nothing more
        "html_show_sphinx": False,
        "html_show_copyright": False,
        "html_use_index": False,
        "nitpicky": True,
    }
