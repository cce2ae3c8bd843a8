"""Rules of what values rest on, and of the tables that say more of a study's values."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.findings.grammar import Vocabulary
from survey_data.problems import Problem
from survey_data.tables import RESTING
from survey_data.validation.cells import Frames, Rule, known_values, problem, texts

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
    known = known_values(frames)
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
    known = known_values(frames)
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


def _models_are_of_the_study(frames: Frames) -> Iterator[Problem]:
    """Check that compensations and variants are of models that the study has."""
    known = known_values(frames)
    models = Vocabulary(frames["taxonomy"]).values.get("model", set())
    columns = {"compensated_models": ("compensation", "model"), "method_variants": ("model",)}
    for table, names in columns.items():
        for index, (study, *values) in texts(frames[table], "study", *names):
            own = known.get((study, "model"), set())
            for name, value in zip(names, values, strict=True):
                ahead = table == "compensated_models" and name == "model"
                if value not in (models if ahead else own):
                    yield problem(table, index, name, f"{study} has no model {value!r}")
    for index, (study, model, relation) in texts(
        frames["compensated_models"], "study", "model", "relation"
    ):
        if relation == "within" and model not in known.get((study, "model"), set()):
            yield problem("compensated_models", index, "model", f"{study} has no model {model!r}")
    for index, (runs_as, extractor) in texts(frames["method_variants"], "runs_as", "extractor"):
        if runs_as not in models:
            yield problem("method_variants", index, "runs_as", f"unknown model {runs_as!r}")
        if extractor not in Vocabulary(frames["taxonomy"]).values.get("extractor", set()):
            message = f"unknown extractor {extractor!r}"
            yield problem("method_variants", index, "extractor", message)


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
    frame = frames["model_families"]
    held = [model for _, (model,) in texts(frame, "model")]
    for index, model in enumerate(held):
        if model not in models:
            yield problem("model_families", index, "model", f"unknown model {model!r}")
    for model in sorted(models - set(held)):
        yield problem("model_families", len(frame) - 1, "model", f"no row for the model {model!r}")


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
    known = {key for _, (key, venue) in texts(frames["studies"], "key", "venue") if venue}
    for index, (study,) in texts(frames["venues"], "study"):
        if study not in known:
            yield problem("venues", index, "study", f"no venue of {study} in studies.csv")


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
)
