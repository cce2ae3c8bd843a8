"""What is known of two values together: studied, measured, or why neither.

The states of a pair, of which the first that holds is its own:

- ``measured``: pipelines with both are scored here, whether a study has both or not;
- ``studied``: at least one study has both;
- ``impossible``: by the rule of `registry.possibility` the two cannot go together;
- ``unknown``: no study has both, but of at least one that has the one value the other is unknown;
- ``unstudied``: none of these.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from registry.catalogue import Catalogue
from registry.fitting import stages
from registry.measured_pipelines import MeasuredPipeline
from registry.possibility import Possibility, Value
from registry.taxonomy import Plan, attribute_of

State = Literal["measured", "studied", "impossible", "unknown", "unstudied"]
STATES: tuple[State, ...] = ("measured", "studied", "impossible", "unknown", "unstudied")


class PipelineRun(NamedTuple):
    """A pipeline on a data set, by the names that the command line takes."""

    dataset: str
    extractor: str
    model: str

    @property
    def command(self) -> str:
        """The command that measures it, or reads what is published of it."""
        asked = {"dataset": self.dataset, "extractor": self.extractor, "model": self.model}
        options = (f"--{name} {shlex.quote(value)}" for name, value in asked.items())
        return f"sunatlas benchmark {' '.join(options)}"


@dataclass(frozen=True)
class PairEvidence:
    """What is known of two values together.

    Attributes
    ----------
    reason
        Why the two cannot go together; empty where they can. A study that has both all the same
        has several sensors, or does what no implementation does.
    unknown
        Studies that have the one value, and of which the other is unknown.
    pipelines
        How many are measured with both and have an error, counted once a data set.
    best_pipeline
        Whichever of them errs least under the first condition of its data set, of those that
        answer often enough; None where none does.
    possible_run
        A pipeline with both that a data set can score and that was not tried; None without one.
    nearest_dataset
        A data set with one of the two values, where none has both; empty where one has.
    """

    state: State
    reason: str
    unknown: tuple[str, ...]
    pipelines: int
    best_pipeline: MeasuredPipeline | None
    possible_run: PipelineRun | None
    nearest_dataset: str


class Evidence:
    """What is measured of pairs of values, what could be, and what cannot.

    Of `measured` pipelines, and of a plan: every pipeline that can be scored, by architecture.
    """

    def __init__(
        self, catalogue: Catalogue, measured: Sequence[MeasuredPipeline], plan: Plan
    ) -> None:
        self._taxonomy = catalogue.taxonomy
        self._possibility = Possibility(catalogue)
        self._measured: dict[PipelineRun, MeasuredPipeline] = {}
        self._designs_with: dict[Value, set[PipelineRun]] = {}
        self._found: dict[Value, set[PipelineRun]] = {}
        for one in measured:
            run = PipelineRun(one.dataset, one.extractor, one.model)
            self._measured[run] = one
            self._note(run, (one.detector, one.mask), one.extractor_taxonomy, one.stages)
        for architecture, pairs in plan.items():
            for (extractor, model), datasets in pairs.items():
                of = catalogue.extractor(extractor).about.taxonomy
                own = stages(catalogue.model(model))
                for dataset in datasets:
                    self._note(PipelineRun(dataset, extractor, model), architecture, of, own)

    def _note(
        self, run: PipelineRun, sensor: tuple[str, str], extractor: str, models: Iterable[str]
    ) -> None:
        values = (("detector", sensor[0]), ("mask", sensor[1]), ("extractor", extractor))
        for value in (*values, *(("model", model) for model in models)):
            self._designs_with.setdefault(value, set()).add(run)

    def _runs(self, level: str, value: str) -> set[PipelineRun]:
        """Return the pipelines with a value; a parent's are those of its kinds."""
        if (level, value) in self._found:
            return self._found[level, value]
        base = attribute_of(level)
        found = self._found[level, value] = set()
        for one in self._taxonomy.values(base):
            if self._taxonomy.derived_values(level, one) == value:
                for kind in self._taxonomy.kinds(base, one):
                    found |= self._designs_with.get((base, kind), set())
        return found

    def of(
        self, row: Value, column: Value, studied: Sequence[str], unknown: Sequence[str]
    ) -> PairEvidence:
        """Return what is known of two (level, value).

        `studied` are the studies that have both; `unknown` those that have one, and of which the
        other is unknown.
        """
        ours, theirs = self._runs(*row), self._runs(*column)
        both = ours & theirs
        tried = [self._measured[run] for run in both if run in self._measured]
        done = [one for one in tried if one.nominal.rms_deg is not None]
        reason = self._possibility.why_not(row, column)
        holds = {"measured": done, "studied": studied, "impossible": reason, "unknown": unknown}
        state = next(one for one in STATES if holds.get(one, True))
        judged = [one for one in done if one.nominal.is_available]
        # names decide between equal errors: the order of a set is another in each process
        best = min(
            judged,
            key=lambda one: (one.nominal.rms_deg, one.dataset, one.extractor, one.model),
            default=None,
        )
        near = min((run.dataset for run in (theirs or ours)), default="")
        return PairEvidence(
            state=state,
            reason=reason,
            unknown=tuple(unknown),
            pipelines=len(done),
            best_pipeline=best,
            possible_run=min(both - self._measured.keys(), default=None),
            nearest_dataset="" if both else near,
        )


def count(states: Iterable[State]) -> dict[str, int]:
    """Return how many pairs are in each state, in the order of `STATES`."""
    found = list(states)
    return {state: found.count(state) for state in STATES}
