"""The bytes of a recommendation, put together from pieces that many answers have in common.

They are those of the document that `registry.recommendation.Recommendation.to_dict` gives: the
tests hold the two against each other. An architecture that stands in an answer with the same
calibrations and the same studies as in one before is not written again, nor is a pipeline, a node
or a path. What is kept is bounded, and does not depend on who asked.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import Any

from pydantic_core import to_json

from registry.contradiction import against_literature, regret_words
from registry.design_columns import design_columns
from registry.designs import DesignTable, Kept
from registry.judging import OF_STUDIES
from registry.paths import PATH_LEVELS, path_table
from registry.ranked_designs import RankedPlace
from registry.ranking import support
from registry.recommendation import Answered

#: Bytes of each kind of pieces that are kept, all of them dropped when more come: what some two
#: thousand questions make. Twice as many would spare a third of the writing, and fill for an hour.
MOST_BYTES = 8 * 2**20

#: What a key and its place in a dictionary weigh, roughly.
_KEY_BYTES = 200


def encoded(value: Any) -> bytes:
    """Return a value as JSON, what is not finite as null."""
    return to_json(value, inf_nan_mode="null")


class KeptPieces:
    """Pieces by what they depend on, bounded by their bytes.

    Parameters
    ----------
    most_bytes : dropped are all when one more would be too many
    """

    def __init__(self, most_bytes: int | None = None) -> None:
        self._most = MOST_BYTES if most_bytes is None else most_bytes
        self._pieces: dict[Hashable, bytes] = {}
        self._bytes = 0
        self.get = self._pieces.get

    def keep(self, key: Hashable, piece: bytes) -> bytes:
        """Keep a piece, and return it."""
        self._bytes += len(piece) + _KEY_BYTES
        if self._bytes > self._most:
            self._pieces.clear()
            self._bytes = len(piece) + _KEY_BYTES
        self._pieces[key] = piece
        return piece


class Pieces:
    """The pieces of the answers about one table of designs.

    Parameters
    ----------
    table : of the designs
    """

    def __init__(self, table: DesignTable) -> None:
        paths, columns = path_table(table.facts), design_columns(table)
        self._size = 8 * columns.words
        self._studies = _by_byte(table.facts.keys, self._size)
        self._left_out = encoded([left.to_dict() for left in paths.left_out])
        self._architectures = KeptPieces()
        self._measured = KeptPieces()
        self._behind = {name: KeptPieces() for name in ("paths", "nodes", "links")}
        self._heads: list[bytes | None] = [None] * len(columns.designs)
        self._path_heads = [
            _head(dict(zip(PATH_LEVELS, path, strict=True))) + b',"studies":['
            for path in paths.paths
        ]
        self._node_heads = [
            _head({"id": f"{level}:{value}", "level": level, "value": value, "name": name})
            + b',"count":%d,"studies":['
            for level, value, name in (tuple(map(_doubled, node)) for node in paths.nodes)
        ]
        self._link_heads = [
            _head({"source": _doubled(source), "target": _doubled(target)})
            + b',"value":%d,"studies":['
            for source, target in paths.links
        ]

    def document(self, found: Answered, limit: int | None, calibrations: int | None) -> bytes:
        """Return an answer, with the first architectures and the first calibrations of each."""
        question, ranked, taken = found.question, found.ranked, found.taken
        asked = question.asked
        lost = found.regret
        blocked = found.blocked
        untried = {
            hazard: [{"detector": detector, "mask": mask} for detector, mask in pairs]
            for hazard, pairs in found.untried.items()
        }
        return b"".join(
            (
                *(b'{"requirements":', encoded(asked.to_dict())),
                *(b',"sort":', encoded(ranked.sort)),
                b',"count":%d,"designs":%d' % (len(ranked.places), ranked.count),
                *(b',"architectures":[', self._listed(found, limit, calibrations)),
                *(b'],"contradictions":', encoded(found.contradictions)),
                b',"regret":',
                encoded(None if lost is None else lost.to_dict(regret_words(lost))),
                *(b',"untried":', encoded(untried)),
                *(b',"paths":[', self._sets("paths", taken.paths, self._path)),
                *(b'],"nodes":[', self._sets("nodes", taken.nodes, self._node)),
                *(b'],"links":[', self._sets("links", taken.links, self._link)),
                *(b'],"left_out":', self._left_out),
                *(b',"blocked":', encoded(None if blocked is None else blocked.to_dict()), b"}"),
            )
        )

    def studies(self, bits: bytes) -> bytes:
        """Return the keys of a set of studies, quoted and with commas between them."""
        found = b"".join([keys[byte] for keys, byte in zip(self._studies, bits, strict=True)])
        return found[:-1]

    def _sets(
        self, kind: str, sets: Iterable[tuple[int, bytes]], make: Callable[[int, bytes], bytes]
    ) -> bytes:
        kept = self._behind[kind]
        get, keep = kept.get, kept.keep
        return b",".join([get(key) or keep(key, make(*key)) for key in sets])

    def _path(self, at: int, bits: bytes) -> bytes:
        return self._path_heads[at] + self.studies(bits) + b"]}"

    def _node(self, at: int, bits: bytes) -> bytes:
        return self._node_heads[at] % _count(bits) + self.studies(bits) + b"]}"

    def _link(self, at: int, bits: bytes) -> bytes:
        return self._link_heads[at] % _count(bits) + self.studies(bits) + b"]}"

    def _listed(self, found: Answered, limit: int | None, calibrations: int | None) -> bytes:
        question, sort = found.question, found.ranked.sort
        columns, meeting = question.columns, question.meeting
        asked, judged = question.asked, question.judged_by
        # All that an architecture's piece depends on, beside its own designs and studies.
        context = (
            *(sort, calibrations, judged.hazards, columns.half_field(judged.half_field_deg)),
            *(judged.min_availability, judged.max_latency_us, question.limits),
            *(bool(asked.properties), *(asked.include.get(name) for name in OF_STUDIES)),
        )
        get, keep = self._architectures.get, self._architectures.keep
        beaten = found.pareto
        listed: list[bytes] = []
        for at, place in enumerate(found.ranked.places[:limit]):
            designs = meeting & columns.of_place[place.number]
            finest = question.finest.get(place.number)
            key = (context, place.number, designs, place.studies, place.stated, finest)
            piece = get(key) or keep(key, self._architecture(place, found, calibrations))
            before, _, after = piece.partition(b"\n")
            listed += (
                *(b",{" if at else b"{", b'"rank":%d,' % (at + 1), before),
                *(b',"pareto":true,' if at in beaten else b',"pareto":false,', after),
            )
        return b"".join(listed)

    def _architecture(self, place: RankedPlace, found: Answered, most: int | None) -> bytes:
        """Return an architecture without its rank; a line feed stands where `pareto` belongs."""
        detector, mask = place.place.architecture
        best = int((place.designs == place.best_at).argmax())
        tasks = [
            {"task": task, "studies": n, "advised": advised}
            for task, (n, advised) in found.tasks(place).items()
        ]
        before = {
            "detector": detector,
            "mask": mask,
            "tasks": tasks,
            "advised": bool(place.advice),
            "advice": [advice.to_dict() for advice in place.advice],
        }
        after = {
            "contradiction": against_literature(place, place.usual),
            "count": len(place.designs),
        }
        question = found.question
        basis = {
            measured: encoded(question.basis(place.place, measured=measured))
            for measured in (True, False)
        }
        calibrations = [
            self._calibration(at, question.kept(design), place, found, basis)
            for at, design in enumerate(place.designs[:most].tolist())
        ]
        return b"".join(
            (
                *(encoded(before)[1:-1], b',"studies":[', self._of_bits(place.studies)),
                *(b'],"best":', self._calibration(best, place.best, place, found, basis)),
                *(b"\n", encoded(after)[1:-1]),
                *(b',"calibrations":[', b",".join(calibrations), b"]}"),
            )
        )

    def _calibration(
        self,
        at: int,
        kept: Kept,
        place: RankedPlace,
        found: Answered,
        basis: dict[bool, bytes],
    ) -> bytes:
        return b"".join(
            (
                *(b'{"rank":%d,' % (at + 1), self._head(kept)),
                self._of_bits(place.taken(kept)),
                b'],"with_model":%d,"support":' % place.with_model(kept).bit_count(),
                *(encoded(round(support(kept, place), 4)), b',"measured":'),
                self._of_row(kept, place.number, found),
                *(b',"basis":', basis[kept.row is not None], b"}"),
            )
        )

    def _head(self, kept: Kept) -> bytes:
        head = self._heads[kept.at]
        if head is None:
            design = kept.design
            about = {
                "extractor": design.extractor,
                "compensations": list(design.stages[:-1]),
                "model": design.model,
                "advised": [advice.id for advice in design.advice],
            }
            head = self._heads[kept.at] = encoded(about)[1:-1] + b',"studies":['
        return head

    def _of_row(self, kept: Kept, place: int, found: Answered) -> bytes:
        """Return what is measured of a calibration, and its best on each other data set."""
        if kept.row is None:
            return b'null,"other_datasets":[]'
        question = found.question
        asked, judged = question.asked, question.judgements
        key = (judged.hazards, judged.half, kept.row_at, question.finest.get(place))
        piece = self._measured.get(key)
        if piece is None:
            partly = question.partly(place)
            others = [row.to_dict(asked, partly) for row in found.others(kept)]
            piece = self._measured.keep(
                key,
                encoded(kept.row.to_dict(asked, partly)) + b',"other_datasets":' + encoded(others),
            )
        return piece

    def _of_bits(self, bits: int) -> bytes:
        return self.studies(bits.to_bytes(self._size, "little"))


_PIECES: weakref.WeakKeyDictionary[DesignTable, Pieces] = weakref.WeakKeyDictionary()


def encoded_answer(
    found: Answered, limit: int | None = None, calibrations: int | None = None
) -> bytes:
    """Return an answer as JSON.

    Parameters
    ----------
    found : the answer
    limit, calibrations : the most architectures, and calibrations of each; None for all
    """
    table = found.question.table
    pieces = _PIECES.get(table)
    if pieces is None:
        pieces = _PIECES[table] = Pieces(table)
    return pieces.document(found, limit, calibrations)


def _by_byte(keys: Sequence[str], size: int) -> list[list[bytes]]:
    """Return, of each byte of a set and each of its values, the keys of its bits, all quoted."""
    quoted = [encoded(key) + b"," for key in keys]
    quoted += [b""] * (8 * size - len(quoted))
    return [
        [
            b"".join(quoted[8 * byte + bit] for bit in range(8) if value >> bit & 1)
            for value in range(256)
        ]
        for byte in range(size)
    ]


def _head(about: dict[str, str]) -> bytes:
    return encoded(about)[:-1]


def _doubled(text: str) -> str:
    """Return text for a template in which % stands for what is put in."""
    return text.replace("%", "%%")


def _count(bits: bytes) -> int:
    return int.from_bytes(bits, "little").bit_count()
