"""`python -m benchmark.retraining`: train all networks again, from nothing but the simulator.

With names, only those. Weights go beside the code that reads them; the same machine gives the same
digits with any number of workers.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from benchmark.learned import centre_training, sparse_training
from benchmark.learned.frames import TRAINING
from benchmark.learned.network import Network
from benchmark.learned.networks import NETWORKS
from benchmark.learned.plans import CENTRES, SEEDS
from benchmark.learned.training import LearnExtraMissingError, torch
from benchmark.learned_faults import training as fault_training
from benchmark.learned_faults.deep import WEIGHTS
from benchmark.processes import call_to_end
from benchmark.running.workers import as_completed
from benchmark.segmentation import training as mask_training
from benchmark.segmentation.unet import weights_of

#: What trains a group of networks: networks by their files.
Trainer = Callable[[], Mapping[Path, Network]]


def trainers() -> Mapping[str, Trainer]:
    """Return what trains each group of networks, by its name."""
    centres = {f"centres-{name}": partial(_centres, name) for name in CENTRES}
    masks = {f"segmentation-{board}": partial(_masks, board) for board in mask_training.FRAMES}
    return {**centres, "sscnn": _sparse, "sscnn-faults": _faults, **masks}


def _faults() -> dict[Path, Network]:
    return {WEIGHTS: fault_training.trained_anew()}


def _masks(board: str) -> dict[Path, Network]:
    return {weights_of(board): mask_training.trained_anew(board)}


def _centres(name: str) -> dict[Path, Network]:
    plan = CENTRES[name]
    learned = centre_training.examples(plan, name, TRAINING, plan.frames)
    found = {}
    for seed in SEEDS.get(name, (0,)):
        made = centre_training.train_centres(name, plan, seed, learned)
        found[NETWORKS / f"centres-{name}-{seed}.npz"] = centre_training.validated(name, plan, made)
    return found


def _sparse() -> dict[Path, Network]:
    count = sparse_training.FRAMES
    learned = sparse_training.examples(TRAINING, count, "train")
    said: dict[str, Any] = {"units": [TRAINING.start, TRAINING.stop - 1]}
    made = sparse_training.train_sparse("sscnn", learned, said)
    found = {NETWORKS / "sscnn.npz": sparse_training.validated(made)}
    light, aims = sparse_training.examples([1], max(sparse_training.OF_ONE)[0], "one")
    for frames, steps in sparse_training.OF_ONE:
        name = sparse_training.name_of_one(frames, steps)
        part = light[:frames], aims[:frames]
        made = sparse_training.train_sparse(name, part, {"units": [1, 1]}, steps)
        found[NETWORKS / f"{name}.npz"] = made
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Train networks and write their files."""
    known = trainers()
    parser = argparse.ArgumentParser(
        prog="python -m benchmark.retraining", description=main.__doc__
    )
    parser.add_argument("names", nargs="*", help="groups; all by default")
    parser.add_argument("--directory", type=Path, help="where files go instead")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.names if name not in known]:
        parser.error(f"no networks {unknown[0]!r}; there are {', '.join(known)}")
    try:
        torch()
    except LearnExtraMissingError as error:
        parser.error(str(error))
    if options.workers < 1:
        parser.error(f"--workers must be at least 1; got {options.workers}")
    groups = [_Group(name, options.directory) for name in options.names or known]
    with closing(as_completed(_trained, groups, options.workers)) as done:
        for name, seconds in done:
            sys.stderr.write(f"{name}: {seconds:.0f} s of one core\n")
    return 0


class _Group(NamedTuple):
    """What is trained together, and where its files go, None for where they are read."""

    name: str
    directory: Path | None


def _trained(group: _Group) -> tuple[str, float]:
    """Train a group and write its files; return its name and the processor's seconds."""
    begun = time.process_time()
    for file, network in trainers()[group.name]().items():
        network.save(group.directory / file.name if group.directory else file)
    return group.name, time.process_time() - begun


if __name__ == "__main__":
    call_to_end(main)
