"""A convention that a file seems to follow, and settings with it applied."""

from __future__ import annotations

from dataclasses import dataclass

from calibrate.settings import Settings, Transform

#: A hypothesis is reported where it leaves less than this share of the residual as stated.
BETTER = 0.8
MUCH_BETTER = 0.5


@dataclass(frozen=True)
class Finding:
    """A convention that the file seems to follow in place of the one stated."""

    about: str  # axes, boresight, angles, unit, rows, runs, quadrants, faces, ...
    found: str  # what was found, in a sentence
    before_deg: float  # RMS of what a low-order map leaves as stated
    after_deg: float  # and with the change
    change: dict[str, object]  # settings that would apply it; empty where none can
    certain: bool  # whether the evidence is practically certain
    note: str = ""  # what else would look the same


def change_of(settings: Settings, finding: Finding) -> Settings:
    """Return settings with a finding's change applied; as they are where it has none."""
    changed = settings
    for part, values in finding.change.items():
        if part == "apply":
            transforms: tuple[Transform, ...] = (*changed.apply, *values)  # type: ignore[misc]
            changed = changed.model_copy(update={"apply": transforms})
        else:
            inner = getattr(changed, part).model_copy(update=values)
            changed = changed.model_copy(update={part: inner})
    return changed
