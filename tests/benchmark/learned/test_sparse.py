"""Submanifold convolution against dense convolution times the mask of lit pixels."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.learned.centres import Look
from benchmark.learned.network import Network, convolution
from benchmark.learned.sparse import HEADS, LIT, SparseReader, layers, sites_of, submanifold

DRAWN = np.random.default_rng(7)
LOOK = Look(24, 7)


def drawn(*shape: int) -> np.ndarray:
    return DRAWN.normal(size=shape).astype(np.float32)


def network() -> Network:
    made = layers(4, hidden=6)
    return Network(
        made,
        {one.name: (0.3 * drawn(*one.shape), drawn(one.shape[0])) for one in made if one.shape},
        {},
    )


@pytest.mark.parametrize("size", [1, 3, 5])
def test_a_submanifold_convolution_is_the_dense_one_held_to_the_mask(size) -> None:
    light = np.maximum(drawn(3, 1, 12, 10) - 0.8, 0.0)
    light[:, :, 5, 5] = 1.0
    sites = sites_of(light)
    lit = np.zeros((3, 12, 10), dtype=bool)
    lit[tuple(sites.T)] = True
    weights = drawn(4, 1, size, size), drawn(4), drawn(2, 4, size, size), drawn(2)
    dense = np.maximum(convolution(*weights[:2], light * lit[:, None]), 0.0) * lit[:, None]
    dense = convolution(*weights[2:], dense)
    values = light[:, 0][tuple(sites.T)][:, None]
    found = submanifold(
        *weights[2:], np.maximum(submanifold(*weights[:2], values, sites), 0.0), sites
    )
    np.testing.assert_allclose(found, dense.transpose(0, 2, 3, 1)[tuple(sites.T)], atol=1e-5)


def spot(x: float, y: float) -> np.ndarray:
    rows, columns = np.mgrid[:40, :50]
    return 500.0 * np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 6.0)[None]


def test_a_spot_moved_by_whole_pixels_moves_its_means_of_coordinates_alone() -> None:
    made = network()
    weights = {**made.weights}
    weights["angles"] = (np.zeros_like(weights["angles"][0]), np.zeros_like(weights["angles"][1]))
    straight = np.zeros((2, 2 * HEADS), dtype=np.float32)
    straight[0, 0] = straight[1, HEADS] = 1.0
    weights["linear"] = straight, np.zeros(2, dtype=np.float32)
    reader = SparseReader(Network(made.layers, weights, {}), LOOK, (20.0, 20.0), 10.0)
    here, there = (reader.read(spot(x, y), None)[0] for x, y in ((20.3, 18.2), (25.3, 21.2)))
    np.testing.assert_allclose(there - here, [[0.5, 0.3]], atol=1e-5)
    windowed, _ = reader.read(spot(20.3, 18.2), np.array([[5, 3]]))
    np.testing.assert_allclose(windowed, there, atol=1e-5)


def test_a_frame_without_light_has_no_direction() -> None:
    reader = SparseReader(network(), LOOK, (20.0, 20.0), 10.0)
    found, _ = reader.read(np.concatenate([spot(20.0, 20.0), np.zeros((1, 40, 50))]), None)
    assert np.isfinite(found).all(axis=1).tolist() == [True, False]
    assert 0.0 < LIT < 1.0
