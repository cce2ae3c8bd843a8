"""Forged bundles: something in one is changed and every digest in it made to fit."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path

from api.deposit.crate import CRATE
from api.deposit.frames import FOLDER
from api.deposit.package import DESCRIPTOR
from benchmark.datasets.checksums import CHECKSUMS, read_checksums, sha256, write_checksums
from tools.faults.forging import forged_export


def forged_bundle(rng: random.Random, bundle: Path) -> str:
    """Forge a bundle; return how."""
    change = rng.choice((number, number, number, row_out, text, samples, file_more, form))
    change(rng, bundle)
    fit(bundle)
    return f"forged: {change.__name__.replace('_', ' ')}"


def fit(bundle: Path) -> None:
    """Make descriptor, crate and checksums fit what is there."""
    package = json.loads((bundle / DESCRIPTOR).read_text("utf-8"))
    kept = [r for r in package["resources"] if (bundle / r["path"]).is_file()]
    for resource in kept:
        path = bundle / resource["path"]
        resource.update(bytes=path.stat().st_size, hash=f"sha256:{sha256(path)}")
    package["resources"] = kept
    (bundle / DESCRIPTOR).write_text(json.dumps(package, indent=2, ensure_ascii=False) + "\n")
    (bundle / CHECKSUMS).unlink(missing_ok=True)
    write_checksums(bundle)
    listed = read_checksums(bundle)
    crate = json.loads((bundle / CRATE).read_text("utf-8"))
    known = {entity["@id"] for entity in crate["@graph"]}
    for name in listed.keys() - known - {CRATE}:
        crate["@graph"].append({"@id": name, "@type": "File"})
    for entity in crate["@graph"]:
        if entity["@id"] in listed and entity["@id"] != CRATE:
            size = (bundle / entity["@id"]).stat().st_size
            entity.update(sha256=listed[entity["@id"]], contentSize=str(size))
    (bundle / CRATE).write_text(json.dumps(crate, indent=2, ensure_ascii=False) + "\n")
    (bundle / CHECKSUMS).unlink()
    write_checksums(bundle)


def number(rng: random.Random, bundle: Path) -> None:
    """Raise one digit of a table of measurements or facts."""
    tables = [*bundle.glob("benchmark/*.csv"), *bundle.glob("survey/*.csv")]
    path = rng.choice(sorted(tables))
    data = bytearray(path.read_bytes())
    start = data.index(b"\n")
    places = [at for at in range(start, len(data)) if data[at] in b"12345678"]
    if places:
        data[rng.choice(places)] += 1
        path.write_bytes(data)
    else:
        row_out(rng, bundle)


def row_out(rng: random.Random, bundle: Path) -> None:
    """Leave out a row of a table of measurements."""
    path = rng.choice(sorted(bundle.glob("benchmark/*.csv")))
    lines = path.read_bytes().splitlines(keepends=True)
    del lines[rng.randrange(1, len(lines))]
    path.write_bytes(b"".join(lines))


def text(rng: random.Random, bundle: Path) -> None:
    """Change a letter of what tells of the bundle."""
    names = ("README.md", "CITATION.cff", "LICENSE", "bibliography/studies.bib")
    path = bundle / rng.choice(names)
    data = bytearray(path.read_bytes())
    data[rng.choice([at for at, byte in enumerate(data) if byte in b"abcdefgh"])] += 1
    path.write_bytes(data)


def samples(rng: random.Random, bundle: Path) -> None:
    """Forge the samples of a data set."""
    forged_export(rng, rng.choice(sorted((bundle / FOLDER).iterdir())))


def file_more(rng: random.Random, bundle: Path) -> None:
    """Put in a file that no bundle has, or a table's worth of nothing."""
    (bundle / rng.choice(["run.me", "parquet/scores2.parquet"])).write_bytes(b"x" * 99)


def form(rng: random.Random, bundle: Path) -> None:
    """Change a byte of Parquet or SQLite."""
    forms = [*bundle.glob("parquet/*.parquet"), *bundle.glob("*.sqlite")]
    path = rng.choice(sorted(forms))
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


FORGERIES: tuple[Callable[[random.Random, Path], None], ...] = (
    *(number, row_out, text, samples, file_more, form),
)
