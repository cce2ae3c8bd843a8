"""Public sets of real readings: where they are, what they hold, whose they are."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Block:
    """Numbers that lie in one piece in a file, column after column.

    Attributes
    ----------
    columns : tuple of str
        Their names.
    offset : int
        First byte.
    rows : int
        Of each column; 64-bit floats, little-endian.
    """

    columns: tuple[str, ...]
    offset: int
    rows: int


@dataclass(frozen=True)
class Source:
    """A file, and what it is turned into.

    Attributes
    ----------
    path : str
        Behind the set's address.
    sha256 : str
    written : str
        Name of the file that is written: CSV of the blocks, or the bytes as they are without any.
    blocks : tuple of Block
    """

    path: str
    sha256: str
    written: str
    blocks: tuple[Block, ...] = ()


@dataclass(frozen=True)
class RealSet:
    """A public set of real readings.

    Attributes
    ----------
    name, about : str
        Name in the Atlas, and a description.
    address : str
        Of a fixed version; paths of files follow it.
    licence, citation : str
        To be kept with what is fetched.
    sources : tuple of Source
    """

    name: str
    about: str
    address: str
    licence: str
    citation: str
    sources: tuple[Source, ...]


_RUNS = (
    "a988c89f43372de3e6f82393a38f2e194d71d79bf800688a02b1325751e24783",
    "74be7e2fb080937bd9a428af80125d6cdf0961e4236eaba6dd14a70e99575e94",
    "c3ce01e731884e3d93ad016ecf452fcd258305c4e2ee8d73dbb0bd0ceb9d47b2",
    "f852c5852d3cae9af70658e8874a8d472b9391dae28e284bf0261397e6055bbd",
    "cd60cc25c7592f0f8eeddcdc55e99a756ee2fd0b11e3bfddaea36e73a5ebe504",
    "9895e0a5e45b428553a1dc36c7cfc16c8176da2b807d50be79f454ca63137706",
    "db579a1a646ba5e7779bbe10b75170aa524d72f00fda4faf38cd0e638e61c495",
)
#: Readings and directions, where Julia's JLD2 put them in each run.
_BLOCKS = (
    Block(("q1", "q2", "q3", "q4", "q5", "q6"), 647, 500),
    Block(("sx", "sy", "sz"), 24734, 500),
)

#: Every set, by name.
SETS = {
    "cubesatbox": RealSet(
        "cubesatbox",
        "Six light sensors of a CubeSat in a lit box and the commanded direction of the light; "
        "seven runs of 500 rows, some all zero, some poses far off, faces not named.",
        "https://raw.githubusercontent.com/benjjensen/CubeSatBox/"
        "defbb807386b68e33e10e7f6431bf4b2d04f8ba3/",
        "MIT, Copyright (c) 2022 Benjamin Jensen; see LICENSE",
        "Benjamin Jensen, CubeSatBox, 2022, https://github.com/benjjensen/CubeSatBox, commit "
        "defbb807386b68e33e10e7f6431bf4b2d04f8ba3",
        (
            *(
                Source(
                    f"PerformanceEvaluation/data/day2run{number}.jld2",
                    digest,
                    f"run{number}.csv",
                    _BLOCKS,
                )
                for number, digest in enumerate(_RUNS, 1)
            ),
            Source(
                "LICENSE",
                "088a3640d348dcc2a87b775f820abdcab13cf6c8a9ff085b5c8d7329206f2390",
                "LICENSE",
            ),
        ),
    )
}
