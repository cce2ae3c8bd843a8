"""Masks of the Sun's image by a U-Net and by thresholds, under glare, dirt and other lights."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.running.experiment import RecordedExperiment
from benchmark.segmentation import plots
from benchmark.segmentation.measure import measure
from benchmark.segmentation.methods import BOARDS
from benchmark.segmentation.record import RECORD
from benchmark.segmentation.unet import weights_of
from benchmark.segmentation.worth import pooled
from files.checksums import sha256

_CODE = "benchmark.segmentation.measure"


class Segmentation(RecordedExperiment[str]):
    """Right and wrong answers of thresholds, templates and a small network, fault by fault."""

    name = "segmentation"
    title = "Masks of the Sun's image: U-Net and thresholds"
    record = RECORD

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the network's file, and the data set with its extractor and model."""
        code, components = modules_digest(_CODE), current(self.parts)
        found = {}
        for name, board in BOARDS.items():
            parts = (
                components.digest("datasets", name),
                components.digest("extractors", board.leader.about.name),
                components.digest("models", board.model.about.name),
            )
            weights = sha256(weights_of(name))
            found[name] = short_digest([code, weights, *parts])
        return found

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw what is worth how much under which fault."""
        return {"segmentation.svg": lambda: plots.worths(self.rows())}

    def table(self) -> list[Row]:
        """Return a row for each data set, fault and method; counts over the units that score."""
        return [
            {"dataset": row["dataset"], "fault": fault["fault"], **one}
            for row in self.rows()
            for fault in row["faults"]
            for one in pooled(row, fault)
        ]

    def tasks(self, cells: Sequence[str]) -> Sequence[str]:
        """Make a task of each data set."""
        return cells

    @staticmethod
    def measure(task: str) -> list[tuple[str, Row]]:
        """Read all units of a data set under every fault."""
        return [(task, measure(task))]
