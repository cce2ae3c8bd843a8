"""Rules of what values rest on, and of the tables that say more of a study's values."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.problems import Problem
from survey_data.validation.cells import Frames, Rule, problem, stated, texts

#: By basis, the column that must say where a value comes from, or why it stands there.
_TOLD = {
    "survey-table": "source",
    "survey-text": "source",
    "abstract": "source",
    "inferred": "note",
    "recalled": "note",
}


def _evidence_is_told(frames: Frames) -> Iterator[Problem]:
    """Check that a value names the page or section it is from, or else its reason."""
    for table in ("attributes", "roles", "architectures"):
        if table not in frames:
            continue
        for index, (basis, source, note) in texts(frames[table], "basis", "source", "note"):
            column = _TOLD.get(basis, "")
            if column and not (source if column == "source" else note):
                yield problem(table, index, column, f"basis {basis} without a {column}")


def _roles_are_of_methods(frames: Frames) -> Iterator[Problem]:
    """Check that a role is of one of the study's values, and that it proposed or kept one."""
    known = stated(frames)
    compared: dict[tuple[str, str], set[str]] = {}
    columns = ("study", "attribute", "value", "role")
    for index, (study, attribute, value, role) in texts(frames["roles"], *columns):
        if value not in known.get((study, attribute), ()):
            yield problem("roles", index, "value", f"{study} has no {attribute} {value!r}")
        if role == "compared":
            compared.setdefault((study, attribute), set()).add(value)
        if compared.get((study, attribute), set()) >= known.get((study, attribute), {""}):
            message = f"{study} would have compared every {attribute} that it has"
            yield problem("roles", index, "role", message)


def _sensors_use_every_value(frames: Frames) -> Iterator[Problem]:
    """Check that sensors listed for a study are of its detectors and masks, each of them used."""
    known = stated(frames)
    used: dict[tuple[str, str], set[str]] = {}
    last: dict[str, int] = {}
    for index, (study, *pair) in texts(frames["architectures"], "study", "detector", "mask"):
        last[study] = index
        for attribute, value in zip(("detector", "mask"), pair, strict=True):
            used.setdefault((study, attribute), set()).add(value)
            if value not in known.get((study, attribute), ()):
                message = f"{study} has no {attribute} {value!r}"
                yield problem("architectures", index, attribute, message)
    for (study, attribute), values in used.items():
        for value in sorted(known.get((study, attribute), set()) - values):
            message = f"{study} has the {attribute} {value!r} on none of its sensors"
            yield problem("architectures", last[study], attribute, message)


def _rules_of_empty_cells_parse(frames: Frames) -> Iterator[Problem]:
    """Check that each condition of a rule is a value of the vocabulary."""
    known = {cell for _, cell in texts(frames["taxonomy"], "attribute", "value")}
    for index, (given,) in texts(frames["defaults"], "given"):
        for condition in given.split("&"):
            attribute, _, value = condition.partition("=")
            if (attribute, value) not in known:
                message = f"expected attribute=value of the taxonomy, got {condition!r}"
                yield problem("defaults", index, "given", message)


RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("attributes",), _evidence_is_told),
    (("attributes", "roles"), _roles_are_of_methods),
    (("attributes", "architectures"), _sensors_use_every_value),
    (("taxonomy", "defaults"), _rules_of_empty_cells_parse),
)
