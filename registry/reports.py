"""What studies and built sensors report of an architecture, as numbers a limit can judge."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from registry.designs import Place
from registry.requirements import CLASSES_DEG
from registry.studies import Study
from survey_data.products import BuiltSensor, Product, built_sensors
from survey_data.reported import ReportedAccuracy, reported_accuracies


@dataclass(frozen=True, eq=False)
class Report:
    """A study of the mapping, or a built sensor of the table of hardware, on one architecture.

    Numbers are None where they are not stated. A sensor that a mapped study describes is the
    study's report: what the study does not state is taken from the table of hardware.

    Attributes
    ----------
    key, kind : key of the study, or id of the sensor's row
    family : the same for all variants of one sensor; of a study its key
    name : title of the study (may be empty), or name of the sensor
    accuracy : the figure with its kind of statistic
    classes : accuracy classes: as mapped, else by the figure as an RMS
    power_mw, supply : power drawn from the spacecraft, and whether it is self-powered or passive
    """

    key: str
    kind: Literal["study", "product"]
    family: str
    name: str
    study: Study | None
    accuracy: ReportedAccuracy | None
    classes: tuple[str, ...]
    fov_deg: float | None
    power_mw: float | None
    mass_g: float | None
    rate_hz: float | None
    supply: str

    @property
    def rms_deg(self) -> float | None:
        """The reported accuracy as an RMS, degrees."""
        return None if self.accuracy is None else self.accuracy.rms_deg

    @property
    def words(self) -> str:
        """Who reports what, as the first words of a sentence."""
        said = f"{self.key if self.kind == 'study' else self.name} reports"
        if self.accuracy is None:
            figure = f"class {' and '.join(self.classes)}" if self.classes else "no accuracy"
        else:
            figure = f"{self.accuracy.value_deg:.3g} deg ({self.accuracy.label})"
        over = "" if self.fov_deg is None else f" over {self.fov_deg:g} deg"
        return f"{said} {figure}{over}"


def reports(place: Place) -> Iterator[Report]:
    """Yield the reports of an architecture: its studies, then sensors that none of them describes.

    Of a family of sensors each variant whose figures are stated is a report of its own.
    """
    of_study = {key: product for product in place.products for key in product.studies}
    for key, study in place.studies.items():
        product = of_study.get(key)
        rows = () if product is None else [one for one in _rows(product) if one.study == key]
        yield _of_study(study, rows, product)
    for product in place.products:
        if place.studies.keys().isdisjoint(product.studies):
            for row in _rows(product):
                yield _of_product(row, product)


def _rows(product: Product) -> list[BuiltSensor]:
    return [built_sensors()[one] for one in product.ids]


def _of_study(study: Study, rows: Sequence[BuiltSensor], product: Product | None) -> Report:
    accuracy, fov_deg = study.report("accuracy"), study.number("fov_deg")
    if accuracy is None:
        accuracy = next((found for row in rows if (found := _accuracy(row))), None)
    if fov_deg is None:
        fov_deg = max((row.fov_full_deg for row in rows if row.fov_full_deg), default=None)
    return Report(
        study.key,
        "study",
        study.key,
        study.title,
        study,
        accuracy,
        study.of("accuracy") or _class_of(accuracy),
        fov_deg,
        None if product is None else product.power_mw,
        None if product is None else product.mass_g,
        None if product is None else product.update_hz,
        "" if product is None else product.supply,
    )


def _of_product(row: BuiltSensor, product: Product) -> Report:
    accuracy = _accuracy(row)
    return Report(
        row.id,
        "product",
        product.family,
        row.name,
        None,
        accuracy,
        _class_of(accuracy),
        row.fov_full_deg,
        product.power_mw,
        product.mass_g,
        product.update_hz,
        product.supply,
    )


def _accuracy(row: BuiltSensor) -> ReportedAccuracy | None:
    if row.accuracy_deg is None:
        return None
    return reported_accuracies("accuracy", row.accuracy_deg, row.accuracy_kind or None)


def _class_of(accuracy: ReportedAccuracy | None) -> tuple[str, ...]:
    if accuracy is None:
        return ()
    rms = accuracy.rms_deg
    return tuple(name for name, (least, most) in CLASSES_DEG.items() if least <= rms < most)
