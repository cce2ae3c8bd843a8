"""The bytes of a recommendation, put together from pieces that many answers have in common.

They are those of the document that `registry.recommendation.Recommendation.to_dict` gives: the
tests hold the two against each other. An architecture that stands in an answer with the same
calibrations and the same studies as in one before is not written again, nor is a pipeline, a node
or a path. What is kept is bounded, and does not depend on who asked.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Callable, Hashable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic_core import to_json

from api.http.representations import digest_of
from registry.contradiction import against_literature, regret_words
from registry.design_columns import design_columns
from registry.designs import DesignTable, Kept
from registry.judging import OF_STUDIES
from registry.path_columns import POSITION_BYTES, Sets
from registry.paths import PATH_LEVELS, path_table
from registry.ranked_designs import RankedPlace
from registry.ranking import support
from registry.recommendation import Answered

#: Bytes of each kind of pieces that are kept, all of them dropped when more come: what some two
#: thousand questions make. Twice as many would spare a third of the writing, and fill for an hour.
MOST_BYTES = 8 * 2**20

#: What a key and its place in a dictionary weigh, roughly, and an architecture as it is ranked.
_KEY_BYTES = 200
_PLACE_BYTES = 1500


def encoded(value: Any) -> bytes:
    """Return a value as JSON, what is not finite as null."""
    return to_json(value, inf_nan_mode="null")


class EncodedAnswer(NamedTuple):
    """An answer as JSON, with a digest of it that was cheaper than one of all its bytes."""

    body: bytes
    digest: str


class ArchitecturePiece:
    """An architecture without its rank, in two parts between which `pareto` belongs.

    Most bytes of an answer are such pieces: each is hashed once, not once an answer.
    """

    def __init__(self, before: bytes, after: bytes) -> None:
        self.before = before
        self.after = after
        self.digest = hashlib.sha256(b"%d,%b%b" % (len(before), before, after)).digest()

    def __len__(self) -> int:
        """Return the bytes that keeping it takes, with the ranked architecture in its key."""
        return len(self.before) + len(self.after) + len(self.digest) + _PLACE_BYTES


Piece = TypeVar("Piece", bytes, ArchitecturePiece)


class KeptPieces(Generic[Piece]):
    """Pieces by what they depend on, bounded by their bytes.

    Parameters
    ----------
    most_bytes : dropped are all when one more would be too many
    """

    def __init__(self, most_bytes: int | None = None) -> None:
        self._most = MOST_BYTES if most_bytes is None else most_bytes
        self._pieces: dict[Hashable, Piece] = {}
        self._bytes = 0

    @property
    def get(self) -> Callable[[Hashable], Piece | None]:
        """What returns what is kept under a key; None where nothing is."""
        return self._pieces.get

    def keep(self, key: Hashable, piece: Piece) -> Piece:
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
        self._architectures: KeptPieces[ArchitecturePiece] = KeptPieces()
        self._measured: KeptPieces[bytes] = KeptPieces()
        self._behind: dict[str, KeptPieces[bytes]] = {
            name: KeptPieces() for name in ("paths", "nodes", "links")
        }
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

    def document(
        self, found: Answered, limit: int | None, calibrations: int | None
    ) -> EncodedAnswer:
        """Return an answer, with the first architectures and the first calibrations of each."""
        listed: list[bytes] = []
        digests: list[bytes] = []
        for at, piece in enumerate(self._listed(found, limit, calibrations)):
            rank = b'%b{"rank":%d,' % (b"," if at else b"", at + 1)
            pareto = b',"pareto":true,' if at in found.pareto else b',"pareto":false,'
            listed += (rank, piece.before, pareto, piece.after)
            digests += (rank, piece.digest, pareto)
        start, end = self._asked(found), self._behind_it(found)
        return EncodedAnswer(
            b"".join((*start, *listed, *end)), digest_of(b"".join((*start, *digests, *end)))
        )

    def _asked(self, found: Answered) -> tuple[bytes, ...]:
        """Return what stands before the architectures."""
        ranked = found.ranked
        return (
            *(b'{"requirements":', encoded(found.question.asked.to_dict())),
            *(b',"sort":', encoded(ranked.sort)),
            b',"count":%d,"designs":%d' % (len(ranked.places), ranked.count),
            b',"architectures":[',
        )

    def _behind_it(self, found: Answered) -> tuple[bytes, ...]:
        """Return what follows the architectures: what contradicts them, and the studies behind."""
        taken, lost, blocked = found.taken, found.regret, found.blocked
        untried = {
            hazard: [{"detector": detector, "mask": mask} for detector, mask in pairs]
            for hazard, pairs in found.untried.items()
        }
        return (
            *(b'],"contradictions":', encoded(found.contradictions)),
            *(b',"regret":', encoded(None if lost is None else lost.to_dict(regret_words(lost)))),
            *(b',"untried":', encoded(untried), b',"untimed":%d' % found.untimed),
            *(b',"paths":[', self._sets("paths", taken.paths, self._path)),
            *(b'],"nodes":[', self._sets("nodes", taken.nodes, self._node)),
            *(b'],"links":[', self._sets("links", taken.links, self._link)),
            *(b'],"left_out":', self._left_out),
            *(b',"blocked":', encoded(None if blocked is None else blocked.to_dict()), b"}"),
        )

    def studies(self, bits: bytes) -> bytes:
        """Return the keys of a set of studies, quoted and with commas between them."""
        found = b"".join([keys[byte] for keys, byte in zip(self._studies, bits, strict=True)])
        return found[:-1]

    def _sets(self, kind: str, sets: Sets, make: Callable[[int, bytes], bytes]) -> bytes:
        kept = self._behind[kind]
        pieces = [piece for piece in map(kept.get, sets) if piece is not None]
        if len(pieces) < len(sets):
            pieces = [kept.get(key) or kept.keep(key, make(*_unpacked(key))) for key in sets]
        return b",".join(pieces)

    def _path(self, at: int, bits: bytes) -> bytes:
        return self._path_heads[at] + self.studies(bits) + b"]}"

    def _node(self, at: int, bits: bytes) -> bytes:
        return self._node_heads[at] % _count(bits) + self.studies(bits) + b"]}"

    def _link(self, at: int, bits: bytes) -> bytes:
        return self._link_heads[at] % _count(bits) + self.studies(bits) + b"]}"

    def _listed(
        self, found: Answered, limit: int | None, calibrations: int | None
    ) -> list[ArchitecturePiece]:
        question, finest = found.question, found.question.finest
        asked = question.asked
        # All that an architecture's piece depends on, beside the architecture as it is ranked.
        context = (
            *(calibrations, question.limits, bool(asked.properties)),
            *(asked.draws, asked.largest_deg, asked.exclude_needs),
            *(asked.include.get(name) for name in OF_STUDIES),
        )
        get, keep = self._architectures.get, self._architectures.keep
        listed: list[ArchitecturePiece] = []
        for place in found.ranked.places[:limit]:
            key = (place, finest.get(place.number), context)
            piece = get(key)
            if piece is None:
                piece = keep(key, self._architecture(place, found, calibrations))
            listed.append(piece)
        return listed

    def _architecture(
        self, place: RankedPlace, found: Answered, most: int | None
    ) -> ArchitecturePiece:
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
            "measures": [measure.to_dict() for measure in place.measures],
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
        studies = self._of_bits(place.studies)
        errs_least = self._calibration(best, place.best, place, found, basis)
        return ArchitecturePiece(
            b"".join((encoded(before)[1:-1], b',"studies":[', studies, b'],"best":', errs_least)),
            b"".join((encoded(after)[1:-1], b',"calibrations":[', b",".join(calibrations), b"]}")),
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
        question, asked = found.question, found.question.asked
        key = question.told_by(kept, place)
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
) -> EncodedAnswer:
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


def _unpacked(packed: bytes) -> tuple[int, bytes]:
    """Return the position of a set of studies, and the set."""
    return int.from_bytes(packed[:POSITION_BYTES], "little"), packed[POSITION_BYTES:]


def _count(bits: bytes) -> int:
    return int.from_bytes(bits, "little").bit_count()
