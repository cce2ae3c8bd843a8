"""Pictures of the data sets, which come with the code.

Drawing simulates, which takes up to 20 s of a processor, as optics are tabulated first. So every
picture lies in `PUBLISHED`, named by what it shows: the data set's digest and that of the code that
draws. `python -m api.previews` draws those that lack and removes those of other code; where the
code has been changed since, the service draws the picture when it is first asked for.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from pathlib import Path

from benchmark.processes import call_to_end
from files.atomic import replace_file

#: Pictures that come with the code, ``<data set>.<digest of what it shows>.png``.
PUBLISHED = Path(__file__).resolve().parents[1] / "benchmark" / "datasets" / "previews"

#: What a picture is made by, beside the data set.
_DRAWN_BY = "benchmark.datasets.preview"


def published_preview(name: str) -> Path:
    """Return where the published picture of a data set lies, if it is of today's code."""
    return PUBLISHED / f"{name}.{_show(name)}.png"


@cache
def png(name: str) -> bytes:
    """Return the picture of a data set; waits where it has to be drawn."""
    with suppress(OSError):
        return published_preview(name).read_bytes()
    return _drawn(name)


@cache
def _show(name: str) -> str:
    from benchmark import datasets  # noqa: PLC0415 - slow, and not needed to import the service
    from benchmark.canonical import digest as digest_of  # noqa: PLC0415 - as above
    from benchmark.results.digests import condition_digests  # noqa: PLC0415 - as above
    from benchmark.results.modules import modules_digest  # noqa: PLC0415 - as above

    shown = condition_digests(datasets.get(name))["nominal"]
    return digest_of([shown, modules_digest(_DRAWN_BY)])[:16]


def _drawn(name: str) -> bytes:
    from benchmark import datasets  # noqa: PLC0415 - as above
    from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - as above

    return preview_png(datasets.get(name))


def main() -> int:
    """Draw the pictures that are not published as the code is now; remove all others."""
    from benchmark import datasets  # noqa: PLC0415 - as above
    from benchmark.progress import console_progress  # noqa: PLC0415 - Rich

    PUBLISHED.mkdir(exist_ok=True)
    wanted = {name: published_preview(name) for name in datasets.names()}
    lacking = [name for name, path in wanted.items() if not path.is_file()]
    with console_progress("drawing") as report:
        for done, name in enumerate(lacking):
            report(done, len(lacking), name)
            replace_file(wanted[name], _drawn(name))
    for found in set(PUBLISHED.glob("*.png")) - set(wanted.values()):
        found.unlink()
    return 0


if __name__ == "__main__":
    call_to_end(main)
