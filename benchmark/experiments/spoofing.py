"""A laser beside the Sun or instead of it: which sensors believe it, which tests notice it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property

from benchmark.as_sold.measure import best_pipeline
from benchmark.contract import Cell
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment
from benchmark.spoofing import plots
from benchmark.spoofing.measure import RATES, Counts, SpoofTask, measure
from benchmark.spoofing.readings import Calibrated
from benchmark.spoofing.record import RECORD, cell_of

_CODE = "benchmark.spoofing.measure"
_CUBE = "pd-maskless-cube"
_FEW, _WINDOW = Counts(20_000, 100_000, 4_000, 1_000), Counts(2_000, 6_000, 1_000, 200)
#: Data sets that a laser is shone at.
SENSORS: Mapping[str, Counts] = {
    "qpd-single-aperture": _FEW,
    "cmos-single-aperture": _WINDOW,
    "cmos-multi-aperture": Counts(300, 400, 400, 40),
    "cmos-encoded": Counts(400, 800, 400, 60),
    "cmos-l-slit": Counts(400, 1_000, 400, 60),
    "event-single-aperture": Counts(2_000, 6_000, 400, 60),
    _CUBE: Counts(5_000, 20_000, 1_000, 300),
}
#: Read by a second extractor, which has an answer to two lights.
ALSO = (("cmos-single-aperture", "bcm"),)

#: Tests by which a reading alarms. Bare faces have none beside them to agree with.
_TESTS = ("pattern", "brightness", "agreement")


class Spoofing(RecordedExperiment[str]):
    """Lasers of 0.1 to 10 Suns beside the Sun and alone: who believes them, and who notices."""

    name = "spoofing"
    title = "Lasers that pass for the Sun"
    record = RECORD

    @cached_property
    def pipelines(self) -> Mapping[str, Cell]:
        """What leads each sensor's standard unit, by its cell's name."""
        rows, found = Store(self.directory).rows(), {}
        for name, extractor in [*((name, None) for name in SENSORS), *ALSO]:
            first = self.parts.preset(name).conditions[0]
            of = [row for row in rows if extractor in {None, row["extractor"]}]
            best = best_pipeline(of, self.parts.models, name, first, table=True)
            if best is not None:
                found[f"{name}/{best[0]}"] = Cell(name, first, *best)
        return found

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the counts, and data set, extractor and model of each and the faces."""
        cells, code = self.pipelines, modules_digest(_CODE)
        components = current(self.parts.only(list(cells.values())))
        kinds = ("dataset", "extractor", "model")

        def digests(*of: Cell) -> list[str]:
            return [components.digest(f"{k}s", getattr(one, k)) for one in of for k in kinds]

        faces = [cell for cell in cells.values() if cell.dataset == _CUBE]
        return {
            name: short_digest([code, SENSORS[cell.dataset], *digests(cell, *faces)])
            for name, cell in cells.items()
        }

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw what is noticed by level, and by the rate of false alarms."""
        return {
            "spoofing.svg": lambda: plots.levels(self.rows()),
            "spoofing-roc.svg": lambda: plots.curves(self.rows()),
        }

    def table(self) -> list[Row]:
        """Return a row for each sensor and laser; lasers that rise are in the rows alone."""
        return [_flat(sensor, level) for sensor in self.rows() for level in sensor["levels"]]

    def tasks(self, cells: Sequence[str]) -> Iterator[SpoofTask]:
        """Make a task of each sensor; masked ones have bare faces beside them."""
        parts = self.parts
        made = {
            name: Calibrated(
                parts.preset(of.dataset), parts.extractor(of.extractor), parts.model(of.model)
            )
            for name, of in self.pipelines.items()
        }
        faces = next((one for one in made.values() if one.preset.name == _CUBE), None)
        for one in (made[name] for name in cells):
            beside = None if one.preset.name == _CUBE else faces
            yield SpoofTask(one, beside, SENSORS[one.preset.name])

    @staticmethod
    def measure(task: SpoofTask) -> list[tuple[str, Row]]:
        """Set thresholds on clean readings, then shine the laser."""
        row = measure(task)
        return [(cell_of(row), row)]


def _flat(sensor: Row, level: Row) -> Row:
    """Return what came of one laser, then of the sensor's clean readings, in cells."""
    noticed = {f"noticed_{name}": level["noticed"].get(name) for name in (*_TESTS, "either")}
    curve = zip(RATES, level["curve"], strict=True)
    alarms = {f"checking_alarms_{name}": sensor["alarms"].get(name) for name in _TESTS}
    return {
        **{name: sensor[name] for name in ("dataset", "extractor", "model")},
        **{name: value for name, value in level.items() if name not in {"noticed", "curve"}},
        **noticed,
        **{f"noticed_pattern_at_{rate:g}": count for rate, count in curve},
        **{name: sensor[name] for name in ("has_pattern", "own_error_deg", "knowable")},
        **{name: sensor[name] for name in ("setting", "checking")},
        **{f"checking_{name}": sensor[name] for name in ("answered", "flagged")},
        **alarms,
    }
