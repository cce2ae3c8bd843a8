"""Rows of the deposit's tables that the service does not give in this form."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.assessment import Sweep
from api.schema.base import Shape
from api.schema.claims import ClaimRule
from api.schema.curves import CurvePoint
from api.schema.datasets import Dataset
from api.schema.scores import Place
from api.schema.studies import Grade, State
from registry.sensors import Basis


class DepositedDataset(Dataset):
    """A standard data set."""

    half_fov_deg: float


class Pin(Place):
    """A generated split of a data set."""

    version: int = Field(description="Version of the data set.")
    split: str
    n: int = Field(description="Number of samples of the split.")
    data_hash: str
    head_hash: str = Field(description="Hash of the first samples.")
    observable: int | None = Field(description="Number of observable samples in the test split.")
    bound_deg: float | None
    head_bound_deg: float | None = Field(description="Bound of the first samples.")
    bound_unit_deg: float | None
    bench_deg: float | None = Field(description="Error of the standard bench over the field.")
    bench_aligned_deg: float | None = Field(description="The same after boresight alignment.")
    boresight_deg: float | None = Field(description="Error if the answer is the boresight.")
    oracle_deg: float | None = Field(description="Error of the truth with the bound's noise.")


class DepositedSweep(Sweep):
    """An extractor at a point of a sweep."""

    series: str = Field(description="Synthetic feature; none if no feature fits the extractor.")
    sweep: str = Field(description="Varied quantity; none if not measured.")
    point: str = Field(description="Point of the sweep; none if not measured.")
    measured_in: str = Field(description="Unit of rms, bias and bound.")


class DepositedPoint(CurvePoint, Place):
    """A point of a learning curve."""


class Resolution(Place):
    """A pipeline and data set that implement a study."""

    study: str
    edition: str
    grade: Grade
    state: State
    detector: str
    mask: str
    detector_basis: Basis = Field(description="stated, inferred, implied, recalled, defaulted.")
    mask_basis: Basis = Field(description="Basis of the mask.")
    extractor_basis: Basis = Field(description="Basis of the extractor.")
    model_basis: Basis = Field(description="Basis of the model.")
    assumed: list[str] = Field(description="Reason or rule for each part that is not stated.")


class IdentifiedStudy(Shape):
    """A study of either edition."""

    study: str
    edition: str
    title: str | None
    authors: str | None
    year: int | None
    venue: str | None
    type: str
    doi: str | None


class DepositedEdition(Shape):
    """An edition of the studies."""

    edition: str
    edition_title: str = Field(description="Name of the edition.")
    edition_studies: int = Field(description="Number of its studies.")
    edition_last_year: int = Field(description="Year of its latest study.")
    edition_later: int = Field(description="Studies after the latest one of the survey.")
    edition_version: str = Field(description="Version, studies, digits of the SHA-256.")


class ClauseVerdict(Shape):
    """A clause of a finding of the survey, judged by its tables."""

    finding: str = Field(description="Identifier of the finding.")
    clause: int = Field(description="Number of the clause within the finding.")
    finding_verdict: str = Field(description="Verdict over all clauses.")
    verdict: str = Field(description="reproduced, tied, contradicted or undecidable.")
    matching: int = Field(description="Number of studies that match the clause.")
    counted: int = Field(description="Of these, studies with a known value.")
    named: list[str] = Field(description="Studies of each value that the clause names.")
    ranking: list[str] = Field(description="Studies of every value, most first.")
    settled_by: str = Field(description="Counts that decide it, and evidence that would change it.")


class PublicationCount(Shape):
    """Studies of a year or venue."""

    per: Literal["year", "venue"] = Field(description="year or venue.")
    year_or_venue: str = Field(description="The year, or the venue in one spelling.")
    studies_count: int = Field(description="Number of mapped studies.")


class ClaimVerdict(Shape):
    """A claim of the survey with its verdict."""

    claim: str
    claim_verdict: str = Field(description="Its verdict, as `GET /v1/claims` has it.")
    claim_case: str = Field(description="Whether the trial is the sentence's case.")
    claim_sentence: str = Field(description="The survey's sentence, word for word.")
    measured_on: str = Field(description="Data, sensors and methods of the trials.")
    replicate: str = Field(description="Difference between trials: sensor unit or seed.")
    second_method: str = Field(description="Second method of the check.")
    second_agrees: bool | None = Field(description="Whether all its verdicts are the same.")
    explanation: str = Field(description="Explanation of the verdict.")


class DepositedRule(ClaimRule):
    """A criterion of a claim."""

    claim: str
    trials_count: int = Field(description="Number of trials with a result.")


class ClaimTrial(Shape):
    """The statistic of a criterion in a trial."""

    claim: str
    rule: str
    trial: int = Field(description="Number of the trial: sensor unit or seed.")
    statistic_value: float | None = Field(description="The statistic in this trial.")
    second_value: float | None = Field(description="The statistic by the second method.")


class SampleFile(Place):
    """A file of samples in the bundle."""

    split: str
    file: str = Field(description="Path in this bundle.")
    samples: int = Field(description="Samples in the file, all of the split.")
    data_hash: str
