"""Leave out of one lock file what another holds: `python -m tools.lock_beyond FIRST SECOND`.

SECOND is rewritten without the pins that FIRST has. Both are then given to pip together, and no
hash stands twice in the repository. A pin that is for more platforms stays; one of another version
is refused: pip could not install both.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

PIN = re.compile(
    r"^(?P<name>\S+?)==(?P<version>[^ \\\n]+)(?P<where>.*)\n(?:[ \t]+.*\n)*", re.MULTILINE
)


def beyond(first: str, second: str) -> str:
    """Return the pins of the second lock file that the first lacks.

    Raises
    ------
    ValueError
        For a name that they pin to different versions.
    """
    held: dict[str, dict[str, str]] = {}
    for pin in PIN.finditer(first):
        held.setdefault(pin["name"], {})[pin["version"]] = pin["where"]
    kept = []
    for pin in PIN.finditer(second):
        versions = held.get(pin["name"], {})
        if versions and pin["version"] not in versions:
            raise ValueError(f"{pin['name']} is pinned to different versions")
        if versions.get(pin["version"]) != pin["where"]:
            kept.append(pin[0])
    return "".join(kept)


if __name__ == "__main__":
    one, other = map(Path, sys.argv[1:])
    other.write_text(beyond(one.read_text("utf-8"), other.read_text("utf-8")), "utf-8")
