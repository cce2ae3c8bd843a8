"""Rules of what values rest on, and of the tables that say more of a study's values."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.findings.grammar import Vocabulary
from survey_data.problems import Problem
from survey_data.tables import FIRST_ROW, RESTING
from survey_data.validation.cells import (
    Frames,
    Rule,
    cells_of,
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


def _conditions_parse(frames: Frames) -> Iterator[Problem]:
    """Check that each condition of a rule is a value of the vocabulary."""
    known = {cell for _, cell in texts(frames["taxonomy"], "attribute", "value")}
    for table, column in (("defaults", "given"), ("purposes", "given"), ("purposes", "unless")):
        for index, (given,) in texts(frames[table], column):
            for condition in given.split("&") if given else ():
                attribute, _, value = condition.partition("=")
                if (attribute, value) not in known:
                    message = f"expected attribute=value of the taxonomy, got {condition!r}"
                    yield problem(table, index, column, message)


def _advice_speaks_the_vocabulary(frames: Frames) -> Iterator[Problem]:
    """Check that advice names values and categories of the taxonomy, and an architecture."""
    vocabulary = Vocabulary(frames["taxonomy"])
    known = {
        **{name: vocabulary.values.get(name, set()) for name in ("detector", "mask")},
        "model_category": vocabulary.categories("model_category"),
        "extractor": vocabulary.values.get("extractor", set())
        | vocabulary.categories("extractor_family"),
    }
    for index, cells in texts(frames["advice"], *known):
        for (column, values), cell in zip(known.items(), cells, strict=True):
            if cell and cell not in values:
                yield problem("advice", index, column, f"unknown value {cell!r} of {column}")
        if not any(cells[:2]):
            yield problem("advice", index, "mask", "names neither a detector nor a mask")


def _families_cover_the_models(frames: Frames) -> Iterator[Problem]:
    """Check that every model of the taxonomy has its place in the middle ring, and none else."""
    models = Vocabulary(frames["taxonomy"]).values.get("model", set()) - {"None"}
    yield from foreign(frames, "model_families", "model", models, "unknown model {!r}")
    last = len(frames["model_families"]) - 1
    for model in sorted(models - cells_of(frames, "model_families", "model")):
        yield problem("model_families", last, "model", f"no row for the model {model!r}")


def _every_run_can_be_judged(frames: Frames) -> Iterator[Problem]:
    """Check that each study says, or leaves open, how it is calibrated and what its sensor is."""
    ways = ("", "fitted", "in flight", "drawn")
    seen: dict[str, set[str]] = {}
    cells = texts(frames["run_facts"], "study", "fact", "value", "basis")
    for index, (study, fact, value, basis) in cells:
        seen.setdefault(study, set()).add(fact)
        if (value == "") != (basis == "unknown"):
            yield problem("run_facts", index, "basis", "unknown is the basis of an empty value")
        if fact == "calibration" and value not in ways:
            message = f"expected one of {', '.join(ways[1:])}, got {value!r}"
            yield problem("run_facts", index, "value", message)
    last = len(frames["run_facts"]) - 1
    for _, (study,) in texts(frames["studies"], "key"):
        for fact in sorted({"calibration", "layout"} - seen.get(study, set())):
            yield problem("run_facts", last, "study", f"no row {fact} of the study {study!r}")


def _venues_are_of_known_ones(frames: Frames) -> Iterator[Problem]:
    """Check that a venue is given for studies alone that have one."""
    studies = {"studies": frames["studies"].dropna(subset=["venue"])}
    known = cells_of(studies, "studies", "key")
    yield from foreign(frames, "venues", "study", known, "no venue of {} in studies.csv")


def _families_are_of_one_kind(frames: Frames) -> Iterator[Problem]:
    """Check that the rows of a family that give detector, mask or supply agree on it."""
    columns = ("detector", "mask", "supply")
    first: dict[tuple[str, str], tuple[int, str]] = {}
    for index, (family, *cells) in texts(frames["hardware"], "family", *columns):
        for column, cell in zip(columns, cells, strict=True):
            at, held = first.setdefault((family, column), (index, cell)) if cell else (index, cell)
            if cell != held:
                message = f"{family} has {cell} here and {held} in row {at + FIRST_ROW}"
                yield problem("hardware", index, column, message)


def _no_power_has_a_supply(frames: Frames) -> Iterator[Problem]:
    """Check that a supply is given where power is 0, and nowhere beside another power."""
    for index, (power, supply) in texts(frames["hardware"], "power_mw", "supply"):
        if power and (float(power) == 0.0) != bool(supply):
            message = f"power is {float(power):g} mW, yet the supply is {supply!r}"
            yield problem("hardware", index, "supply", message)


RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("attributes",), _evidence_is_told),
    (("attributes", "roles"), _roles_are_of_methods),
    (("attributes", "architectures"), _sensors_use_every_value),
    (
        ("taxonomy", "attributes", "compensated_models", "method_variants"),
        _models_are_of_the_study,
    ),
    (("taxonomy", "defaults", "purposes"), _conditions_parse),
    (("taxonomy", "advice"), _advice_speaks_the_vocabulary),
    (("taxonomy", "model_families"), _families_cover_the_models),
    (("studies", "venues"), _venues_are_of_known_ones),
    (("studies", "run_facts"), _every_run_can_be_judged),
    (("hardware",), _families_are_of_one_kind),
    (("hardware",), _no_power_has_a_supply),
)
