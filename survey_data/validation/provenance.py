"""Rules of what values rest on, and of the tables that say more of a study's values."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.findings.grammar import Vocabulary
from survey_data.problems import Problem
from survey_data.tables import RESTING
from survey_data.validation.cells import (
    Frames,
    Rule,
    foreign,
    known_values,
    of_study,
    problem,
    texts,
)

#: By basis, the column that must say where a value comes from, or why it stands there.
TOLD = {
    "survey-table": "source",
    "survey-text": "source",
    "full-text": "source",
    "abstract": "source",
    "inferred": "note",
    "recalled": "note",
}


def _evidence_is_told(frames: Frames) -> Iterator[Problem]:
    """Check that a value names the page or section it is from, or else its reason."""
    for table in ("attributes", *RESTING):
        if table not in frames:
            continue
        for index, (basis, source, note) in texts(frames[table], "basis", "source", "note"):
            column = TOLD.get(basis, "")
            if column and not (source if column == "source" else note):
                yield problem(table, index, column, f"basis {basis} without a {column}")


def _roles_are_of_methods(frames: Frames) -> Iterator[Problem]:
    """Check that a role is of one of the study's values, and that it proposed or kept one."""
    yield from of_study(frames, "roles", "", ("value",))
    known = known_values(frames)
    compared: dict[tuple[str, str], set[str]] = {}
    columns = ("study", "attribute", "value", "role")
    for index, (study, attribute, value, role) in texts(frames["roles"], *columns):
        if role == "compared":
            compared.setdefault((study, attribute), set()).add(value)
        if compared.get((study, attribute), set()) >= known.get((study, attribute), {""}):
            message = f"{study} would have compared every {attribute} that it has"
            yield problem("roles", index, "role", message)


def _sensors_use_every_value(frames: Frames) -> Iterator[Problem]:
    """Check that sensors listed for a study are of its detectors and masks, each of them used."""
    known = known_values(frames)
    for attribute in ("detector", "mask"):
        yield from of_study(frames, "architectures", attribute, (attribute,))
        used: dict[str, set[str]] = {}
        last: dict[str, int] = {}
        for index, (study, value) in texts(frames["architectures"], "study", attribute):
            last[study] = index
            used.setdefault(study, set()).add(value)
        for study, values in used.items():
            for value in sorted(known.get((study, attribute), set()) - values):
                message = f"{study} has the {attribute} {value!r} on none of its sensors"
                yield problem("architectures", last[study], attribute, message)


def _models_are_of_the_study(frames: Frames) -> Iterator[Problem]:
    """Check that compensations and variants are of models that the study has."""
    vocabulary = Vocabulary(frames["taxonomy"]).values
    models, extractors = (vocabulary.get(name, set()) for name in ("model", "extractor"))
    yield from of_study(frames, "compensated_models", "model", ("compensation",))
    own = known_values(frames)
    columns = ("study", "model", "relation")
    for index, (study, model, relation) in texts(frames["compensated_models"], *columns):
        if relation == "within" and model not in own.get((study, "model"), set()):
            yield problem("compensated_models", index, "model", f"{study} has no model {model!r}")
    yield from of_study(frames, "method_variants", "model", ("model",))
    for table, name, known, what in (
        ("compensated_models", "model", models, "model"),
        ("method_variants", "runs_as", models, "model"),
        ("method_variants", "extractor", extractors, "extractor"),
    ):
        yield from foreign(frames, table, name, known, f"unknown {what} {{!r}}")


RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("attributes",), _evidence_is_told),
    (("attributes", "roles"), _roles_are_of_methods),
    (("attributes", "architectures"), _sensors_use_every_value),
    (("taxonomy", "attributes", "compensated_models", "method_variants"), _models_are_of_the_study),
)
