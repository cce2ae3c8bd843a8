"""Check commit subjects: `area: imperative`, plain, at most 72 characters.

`tools/commit_subject.py FILE` checks the message in a file, as a commit-msg hook;
`tools/commit_subject.py --range BASE..HEAD` checks every commit of a range but merges. Each fault
is printed, and the exit status is then 1. It runs on any Python, without what the project installs.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

LONGEST = 72
FORM = re.compile(r"(?P<area>[a-z][a-z0-9 ,/_.-]*): (?P<what>\S.*)")
#: What git itself writes, and what is folded into another commit before a merge.
EXEMPT = re.compile(r"(Merge|Revert) |(fixup|squash|amend)! ")
#: First words that look like another mood and are none.
IMPERATIVE = frozenset(
    {"address", "bring", "bypass", "cross", "discuss", "dress", "embed", "express", "feed", "focus"}
    | {"guess", "heed", "need", "pass", "press", "process", "seed", "shed", "speed", "string"}
    | {"stress", "suppress", "toss"}
)
_MOODS = (
    (re.compile(r"[a-z]+ing"), "a participle"),
    (re.compile(r"[a-z]+[^aeious]s|[a-z]+es"), "a third person or a plural"),
    (re.compile(r"[a-z]+ed"), "a past tense"),
)


def faults(subject: str) -> list[str]:
    """Return what is wrong with a subject, each in a few words."""
    if EXEMPT.match(subject):
        return []
    found = []
    if len(subject) > LONGEST:
        found.append(f"{len(subject)} characters; at most {LONGEST}")
    form = FORM.fullmatch(subject)
    if form is None:
        return [*found, "expected `area: imperative`, such as `store: refuse a second writer`"]
    what = form["what"]
    if what.endswith("."):
        found.append("no full stop at the end")
    first = what.split()[0].lower()
    mood = next((name for mood, name in _MOODS if mood.fullmatch(first)), None)
    if mood and first not in IMPERATIVE:
        found.append(
            f"{first!r} is {mood}; say what the change does in the imperative, such as `add`"
        )
    return found


def subjects(commits: str) -> list[str]:
    """Return the subjects of a range of commits, merges left out."""
    done = subprocess.run(
        ["git", "log", "--no-merges", "--format=%s", commits],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()


def main(arguments: list[str]) -> int:
    """Check, print faults, and return the exit status."""
    if len(arguments) == 2 and arguments[0] == "--range":
        given = subjects(arguments[1])
    elif len(arguments) == 1:
        lines = Path(arguments[0]).read_text(encoding="utf-8").splitlines()
        given = [next((line for line in lines if not line.startswith("#")), "")]
    else:
        sys.stderr.write(f"{__doc__}")
        return 2
    wrong = [(subject, fault) for subject in given for fault in faults(subject)]
    for subject, fault in wrong:
        sys.stderr.write(f"commit subject {subject!r}: {fault}\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
