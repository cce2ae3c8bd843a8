"""The first example of docs/algorithms.md, run on an image file of the reader's own."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from algorithms.measurement import QualityFlag

PAGE = Path(__file__).resolve().parents[2] / "docs" / "algorithms.md"


def first_example() -> str:
    found = re.search(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found is not None
    return found[1]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_an_image_of_ones_own_takes_four_lines(
    dtype: type, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = [line for line in first_example().splitlines() if line]
    assert len(lines) == 4
    monkeypatch.chdir(tmp_path)
    y, x = np.mgrid[:60, :80]
    disc = 180.0 / (1.0 + np.exp(2.0 * (np.hypot(x - 41.3, y - 25.8) - 9.0)))
    image = np.random.default_rng(5).normal(20.0 + disc, 3.0).round().astype(dtype)
    assert cv2.imwrite("sun.png", image)
    names: dict[str, object] = {}
    exec("\n".join(lines), names)
    found = names["found"]
    assert found.features == pytest.approx(np.array([[41.3, 25.8]]), abs=0.1)  # type: ignore[attr-defined]
    assert (found.deviations < 0.05).all()  # type: ignore[attr-defined]
    assert QualityFlag(found.flags[0]) == QualityFlag(0)  # type: ignore[attr-defined]
    assert cv2.imwrite("sun.png", np.full((60, 80), 20, dtype=dtype))
    exec("\n".join(lines), names)
    assert QualityFlag(names["found"].flags[0]) == QualityFlag.NO_SPOT  # type: ignore[attr-defined]


def test_a_picture_in_colour_is_read_by_its_luminance_or_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    image = np.repeat(disc(33.2, 17.4)[:, :, None], 3, axis=2)
    assert cv2.imwrite("sun.png", image)
    names: dict[str, Any] = {}
    exec(first_example(), names)
    assert names["found"].features == pytest.approx(np.array([[33.2, 17.4]]), abs=0.05)
    with pytest.raises(ValueError, match="picture in colour"):
        names["MirrorRegistration"]().measure(image)


def disc(x_px: float, y_px: float) -> np.ndarray:
    """Return a frame (40, 60) of a disc, uint8."""
    y, x = np.mgrid[:40, :60]
    light = 180.0 / (1.0 + np.exp(2.0 * (np.hypot(x - x_px, y - y_px) - 7.0)))
    noise = np.random.default_rng(5).normal(0.0, 2.0, light.shape)
    return (20.0 + light + noise).round().astype(np.uint8)
