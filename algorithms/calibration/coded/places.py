"""Where the apertures of a built mask are, as the spots of one frame tell against each other."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: Steps that settle how much of the residuals is the apertures'; it changes the offsets little.
_STEPS = 6
#: Least and largest variance of a spot over that of an aperture's place.
_RATIOS = (1e-9, 1e3)


def turn_of(spots: Floats, apertures: NDArray[np.int64], places: Floats) -> float:
    """Degrees by which spots (N, K, 2) of known apertures are turned against their places (A, 2).

    By what they are from the middle of their frame's spots; least squares for a small turn.
    """
    found, own, frames, _ = _sightings(spots, apertures, places)
    seen, drawn = _from_middle(found, frames), _from_middle(own, frames)
    cross = (drawn[:, 0] * seen[:, 1] - drawn[:, 1] * seen[:, 0]).sum()
    along = (drawn * seen).sum()
    return float(np.degrees(np.arctan2(cross, along))) if along > 0 else 0.0


def offsets_of(spots: Floats, apertures: NDArray[np.int64], places: Floats) -> Floats:
    """Offsets (A, 2) of apertures from their places, best linear unbiased prediction.

    A spot is where its aperture is, plus its offset, plus its frame's displacement, which is free,
    plus noise. Both variances are the samples' own: ``(C + q I) o = r`` with C the sightings of
    each aperture less what the frames' displacements take, and q noise over offsets, found by
    expectation and maximisation.

    Parameters
    ----------
    spots : ndarray, shape (N, K, 2)
    apertures : ndarray of int, shape (N, K)
        Of each spot; -1 for none.
    places : ndarray, shape (A, 2)

    Returns
    -------
    ndarray, shape (A, 2)
        Zero for an aperture that was never seen.
    """
    found, own, frames, holes = _sightings(spots, apertures, places)
    offsets = np.zeros_like(places)
    seen, index = np.unique(holes, return_inverse=True)
    if len(seen) < 2 or len(holes) <= len(seen):
        return offsets
    frame_of, frames = np.unique(frames, return_inverse=True)
    away = _from_middle(found - own, frames)
    right = np.zeros((len(seen), 2))
    np.add.at(right, index, away)
    values, vectors = _modes(frames.tobytes(), index.tobytes())
    turned = vectors.T @ right
    freedom = max(2 * (len(holes) - len(frame_of)), 1)
    ratio, total = 1.0, float((away**2).sum())
    answer = np.zeros_like(turned)
    for _ in range(_STEPS):
        answer = turned / (values + ratio)[:, None]
        kept = 2.0 * (values / (values + ratio)).sum()
        left = max(total - 2.0 * (answer * turned).sum() + (values[:, None] * answer**2).sum(), 0.0)
        noise = left / max(freedom - kept, 1.0)
        size = ((answer**2).sum() + noise * 2.0 * (1.0 / (values + ratio)).sum()) / answer.size
        ratio = float(np.clip(noise / size, *_RATIOS)) if size > 0 else _RATIOS[1]
    offsets[seen] = vectors @ answer
    return offsets


# what is seen is mostly what was seen the round before, whose places hardly differ
@lru_cache(maxsize=4)
def _modes(frames: bytes, apertures: bytes) -> tuple[Floats, Floats]:
    """Eigenvalues (A,) and vectors (A, A) of sightings less what frames' displacements take.

    By the frame and the aperture of each sighting, numbered from 0, as bytes of integers.
    """
    frame, aperture = (np.frombuffer(one, dtype=np.int64) for one in (frames, apertures))
    share = np.zeros((frame.max() + 1, aperture.max() + 1))
    np.add.at(share, (frame, aperture), 1.0)
    number = share.sum(axis=1)
    matrix = np.diag(share.sum(axis=0)) - share.T @ (share / number[:, None])
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(values), np.asarray(vectors)


def _sightings(
    spots: Floats, apertures: NDArray[np.int64], places: Floats
) -> tuple[Floats, Floats, NDArray[np.int64], NDArray[np.int64]]:
    """Spots (S, 2), their apertures' places (S, 2), frames (S,) and apertures (S,)."""
    frames, which = np.nonzero(apertures >= 0)
    holes = apertures[frames, which]
    return spots[frames, which], places[holes], frames, holes


def _from_middle(points: Floats, frames: NDArray[np.int64]) -> Floats:
    """Points (S, 2) less the mean of those of their frame."""
    number = np.maximum(np.bincount(frames), 1)
    middle = np.column_stack([np.bincount(frames, weights=column) / number for column in points.T])
    return points - middle[frames]
