"""The sparse network for many spots: against dense layers held to the lit pixels, and no light."""

from __future__ import annotations

import numpy as np

from benchmark.learned.network import Network, convolution, dense
from benchmark.learned.sparse import LIT
from benchmark.learned_faults.deep import WIDTHS, DeepReader, layers, merged, places, shown

DRAWN = np.random.default_rng(11)


def network() -> Network:
    made = layers(hidden=6)
    weights = {
        one.name: (
            (DRAWN.normal(size=one.shape) / np.sqrt(np.prod(one.shape[1:]))).astype(np.float32),
            0.1 * DRAWN.normal(size=one.shape[0]).astype(np.float32),
        )
        for one in made
        if one.shape
    }
    return Network(made, weights, {})


def frames(count: int, spots: int = 7) -> np.ndarray:
    y, x = np.mgrid[:256, :256]
    found = np.zeros((count, 256, 256))
    for k in range(count):
        for cx, cy, light in DRAWN.random((spots, 3)):
            squares = (x - 256.0 * cx) ** 2 + (y - 256.0 * cy) ** 2
            found[k] += 500.0 * light * np.exp(-squares / 150.0)
    return found


def halved(values: np.ndarray) -> np.ndarray:
    return values.reshape(*values.shape[:2], values.shape[2] // 2, 2, -1, 2).max(axis=(3, 5))


def by_dense_layers(of: Network, light: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tangents, and what is said of their error, by convolutions over all pixels and masks."""
    weights, lit = of.weights, (light > LIT).astype(np.float32)
    values = light * lit
    for level in range(len(WIDTHS)):
        if level:
            values, lit = halved(values), halved(lit)
        for k in range(2):
            found = convolution(*weights[f"level{level}_{k}"], values)
            values = np.maximum(found, 0.0) * lit
    shares = np.exp(convolution(*weights["heads"], values)) * lit
    shares /= shares.sum(axis=(2, 3), keepdims=True)
    along = (2.0 * np.arange(8) - 7.0) / 8.0
    x, y = shares.sum(axis=2) @ along, shares.sum(axis=3) @ along
    averaged = np.einsum("nhij,ncij->nhc", shares, values)
    means = np.concatenate([x[:, :, None], y[:, :, None], averaged], axis=2)
    means = bent = means.reshape(len(light), -1).astype(np.float32)
    for name in ("hidden0", "hidden1"):
        bent = np.maximum(dense(*weights[name], bent), 0.0)
    last = dense(*weights["angles"], bent)
    return last[:, :2] + dense(*weights["linear"], means), last[:, 2]


def test_sparse_levels_are_the_dense_ones_held_to_the_lit_pixels() -> None:
    made, given = network(), frames(3)
    expected, stated = by_dense_layers(made, shown(given)[0])
    found, said = DeepReader(made).read(given)
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(said[:, 2], stated, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(np.exp(said[:, 0]), (shown(given)[0] > LIT).sum(axis=(1, 2, 3)))


def test_a_frame_without_light_has_no_answer_and_changes_no_other() -> None:
    reader, given = DeepReader(network()), frames(2)
    found, _ = reader.read(np.concatenate([given[:1], np.zeros((1, 256, 256)), given[1:]]))
    assert np.isfinite(found).all(axis=1).tolist() == [True, False, True]
    alone, _ = reader.read(given)
    np.testing.assert_array_equal(found[[0, 2]], alone)
    empty, _ = reader.read(np.zeros((2, 256, 256)))
    assert np.isnan(empty).all()


def test_an_even_light_over_a_frame_changes_nothing_that_is_shown() -> None:
    given = frames(2, spots=3)
    for one, other in zip(shown(given), shown(given + 40.0), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-5)


def test_answers_beyond_the_limits_are_refused() -> None:
    given = frames(3)
    free, said = DeepReader(network()).read(given)
    brightest = said[:, 1].argmax()
    wide = (-100.0, 100.0)
    limits = [wide, (-100.0, np.delete(said[:, 1], brightest).max()), wide]
    found, _ = DeepReader(network(), limits).read(given)
    assert np.isnan(found).any(axis=1).tolist() == [k == brightest for k in range(3)]
    assert np.isfinite(free).all()


def test_sites_are_merged_where_their_halved_places_are_the_same() -> None:
    sites = np.array([[0, 0, 0], [0, 1, 1], [0, 1, 2], [1, 0, 0]])
    values = np.array([[1.0, 5.0], [2.0, 4.0], [3.0, 3.0], [4.0, 2.0]], dtype=np.float32)
    largest, found = merged(values, sites)
    assert found.tolist() == [[0, 0, 0], [0, 0, 1], [1, 0, 0]]
    assert largest.tolist() == [[2.0, 5.0], [3.0, 3.0], [4.0, 2.0]]


def test_places_are_the_middles_of_sites_over_the_half_width() -> None:
    np.testing.assert_allclose(places(4), [-0.75, -0.25, 0.25, 0.75])
