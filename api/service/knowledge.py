"""All that the service tells: facts, implementations and measurements, each loaded once.

Loading is lazy, so that an application is there at once; `load_all` does it at start-up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import survey_data
from api.schema.advice import Advice
from api.schema.table import columns_of
from api.service.index.entries import entries
from api.service.index.index import Index
from api.service.measurements import Measurements
from files.manifest import manifest_digest
from registry.catalogue import Catalogue, catalogue
from registry.design_table import design_table
from registry.evidence import Evidence
from registry.measured_pipelines import Measurements as Measured
from registry.resolution import Resolution, resolve_all, resolve_later
from registry.studies import Facts, facts
from registry.taxonomy import Plan, Taxonomy
from survey_data import labels
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.editions import Choice, Edition, editions


class Knowledge:
    """Facts, implementations and measurements.

    Parameters
    ----------
    measurements : the published ones by default
    survey : knowledge of the survey's studies, to which those that it does not map are added. What
        runs for a study of the survey is what it is without them: none of them is its relative
    """

    def __init__(
        self, measurements: Measurements | None = None, survey: Knowledge | None = None
    ) -> None:
        self.measurements = Measurements() if measurements is None else measurements
        self._survey = survey
        self.edition: Choice = "survey" if survey is None else "all"

    def of(self, edition: Choice) -> Knowledge:
        """Return the same with the studies of an edition; only these are not shared."""
        if edition == self.edition:
            return self
        return self._with_later if self._survey is None else self._survey

    @cached_property
    def _with_later(self) -> Knowledge:
        return Knowledge(self.measurements, survey=self)

    @cached_property
    def facts(self) -> Facts:
        """Studies and taxonomy, of the survey unless another edition is asked for (`of`)."""
        return facts(self.edition)

    @cached_property
    def editions(self) -> tuple[Edition, Edition]:
        """The survey's studies and those after it, each as it is cited."""
        _ = self.facts
        return editions()

    @cached_property
    def facts_digest(self) -> str | None:
        """SHA-256 of the manifest of the facts, as they were when they were read."""
        _ = self.facts
        return manifest_digest(DATA_DIRECTORY)

    @property
    def taxonomy(self) -> Taxonomy:
        """The vocabulary."""
        return self.facts.taxonomy

    @cached_property
    def catalogue(self) -> Catalogue:
        """The implementations. The first use imports every one of them."""
        return catalogue() if self._survey is None else self._survey.catalogue

    @cached_property
    def resolutions(self) -> Mapping[str, Resolution]:
        """What is scored of each study, by key."""
        from benchmark.plan.combinations import scorable_plan, study_plans  # noqa: PLC0415 - loads the simulator
        from benchmark.plan.shown import data_sets  # noqa: PLC0415 - likewise

        if self._survey is None:
            return self._resolve(study_plans())
        later = resolve_later(
            scorable_plan(),
            self._survey.facts,
            self.facts,
            data_sets=data_sets(),
            catalogue=self.catalogue,
            scores=self.measurements.own_errors,
        )
        return {**self._survey.resolutions, **later}

    @cached_property
    def standard_resolutions(self) -> Mapping[str, Resolution]:
        """The same on standard data sets alone, where methods can be compared."""
        return self._resolve({})

    def _resolve(self, own: Mapping[str, Plan]) -> Mapping[str, Resolution]:
        from benchmark.plan.combinations import scorable_plan  # noqa: PLC0415 - as above
        from benchmark.plan.shown import data_sets  # noqa: PLC0415 - likewise

        return resolve_all(
            scorable_plan(),
            own=own,
            data_sets=data_sets(),
            catalogue=self.catalogue,
            facts=self.facts,
            scores=self.measurements.own_errors,
        )

    @cached_property
    def evidence(self) -> Evidence:
        """What is measured of pairs of values, what could be, and what cannot."""
        from benchmark.plan.combinations import scorable_plan  # noqa: PLC0415 - loads the simulator

        if self._survey is not None:
            return self._survey.evidence
        return Evidence(self.catalogue, self.measurements.pipelines, scorable_plan())

    @cached_property
    def measured_pipelines(self) -> Measured:
        """What is measured of every pipeline, as recommendations take it."""
        if self._survey is not None:
            return self._survey.measured_pipelines
        return Measured(self.measurements.pipelines)

    @cached_property
    def advice(self) -> Sequence[Mapping[str, str]]:
        """What the survey advises, and where it says errors are met; empty where it leaves open."""
        table = survey_data.load().advice.rename(columns={"survey_section": "section"}).fillna("")
        table["section_name"] = table["section"].map(labels.name)
        names = columns_of(Advice)
        rows = table[list(names)].itertuples(index=False)
        return [dict(zip(names, map(str, row), strict=True)) for row in rows]

    @cached_property
    def index(self) -> Index:
        """What search finds."""
        return Index(entries(self)) if self._survey is None else self._survey.index

    def load_all(self) -> None:
        """Load everything now, so that no request has to wait for it.

        Raises
        ------
        ValueError
            Where a file of facts or of published results cannot be read.
        """
        _ = self.resolutions, self.measurements.scores, self.measurements.times
        _ = (
            self.evidence,
            self.measured_pipelines,
            self.measurements.leaderboard,
            self.measurements.cards,
        )
        _ = self.measurements.sweeps, self.measurements.curves, self.measurements.assessment
        _ = self.measurements.claims, self.index.find("warm")
        _ = self.facts_digest, self.measurements.digest
        _ = self.of("all").resolutions, self.editions
        design_table(self.facts, self.measured_pipelines)
