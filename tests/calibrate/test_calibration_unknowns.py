"""What a calibration leaves unknown, in its numbers, documents, code and certificate."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import bench
import numpy as np
import pytest

from algorithms.calibration.documents import DIGEST
from algorithms.calibration.saving import UnreadableCalibrationError
from calibrate import documents, products
from calibrate.calibration import Calibration, calibrate
from calibrate.documents import load, save, with_correction
from calibrate.recalibration import Correction
from calibrate.recalibration import Errors as CorrectionErrors
from calibrate.report.certificate import certificate

VECTOR = ["sun_x", "sun_y", "sun_z"]
FACES = ["xp", "xm", "yp", "ym", "zp", "zm"]


def spots(path: Path, angles: np.ndarray, noise: float = 0.0, repeats: int = 1) -> Path:
    """A file of a camera, each pose and its reading so many times."""
    features = bench.spots(bench.sun_of(angles), 1)
    features += np.random.default_rng(2).normal(0.0, noise, features.shape)
    return bench.write(
        path, bench.HEADER, *(np.repeat(part, repeats, axis=0) for part in (features, angles))
    )


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return spots(tmp_path_factory.mktemp("nine") / "nine.csv", bench.grid(3, 30.0))


@pytest.fixture(scope="module")
def nine(path: Path) -> Calibration:
    """A calibration by nine poses."""
    return calibrate([path], models=("polynomial-2d",))


@pytest.fixture(scope="module")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Calibration:
    """A calibration of a box of cells at several temperatures."""
    sun = bench.sphere(300, 2)
    kelvin = np.random.default_rng(1).uniform(270.0, 320.0, 300)
    signals = bench.faces(sun, 3) * (1.0 + 0.002 * (kelvin - 295.0))[:, None]
    file = tmp_path_factory.mktemp("warm") / "warm.csv"
    bench.write(file, [*FACES, *VECTOR, "temperature_K"], signals, sun, kelvin)
    return calibrate([file], models=("temperature + basic",))


def names_in(text: str) -> set[str]:
    return {one.text or "" for one in ET.fromstring(text).iter("{https://ptb.de/dcc}content")}


def test_a_certificate_of_nine_poses_has_no_noise_no_rings_and_no_parameters(
    nine: Calibration, warm: Calibration
) -> None:
    left = {"RMS noise of single samples", "Errors by angle from the boresight"}
    assert np.isnan(nine.noise_deg)
    assert nine.intervals is None
    said = names_in(certificate(nine))
    assert (left | {"Parameters of the model"}) & said == set()
    assert "RMS error of samples left out of the fit" in said
    assert left <= names_in(certificate(warm))


def test_no_code_says_why(warm: Calibration, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(products, "report", lambda *_: "")
    about = replace(warm.model.about, context=("nadir",))
    made = products.products(replace(warm, model=replace(warm.model, about=about)), "box")
    assert set(made) == {"box.json", "box_no_code.txt", "box_report.html", "box.sha256"}
    assert made["box_no_code.txt"] == "No code was written: code for flight knows no nadir.\n"


def test_a_correction_is_saved_on_top_of_those_before(nine: Calibration, tmp_path: Path) -> None:
    file = tmp_path / "nine.json"
    save(nine, file)
    first = load(file).document[DIGEST]
    turns = [bench.turn("x", 1.0), bench.turn("z", 2.0)]
    for offset, turn in zip((1.0, 0.25), turns, strict=True):
        rotation = tuple(tuple(float(c) for c in row) for row in turn)
        errors = CorrectionErrors(1.0, 1.0, 1.0, 1.0)
        found = Correction(
            ("offset", "scale"), (2.0, 2.0), (offset, 0.0), rotation, errors, errors, (), 12
        )
        held = with_correction(load(file), found, [tmp_path / "few.csv"], "sunatlas calibrate")
        file.write_text(json.dumps(held), encoding="utf-8")
    loaded = load(file)
    # what was read, f, is now 2 f + 1, and later 2 (2 f + 1) + 0.25
    assert loaded.offset.tolist() == [2.25, 0.0]
    assert loaded.gain.tolist() == [4.0, 4.0]
    assert loaded.rotation == pytest.approx(turns[1] @ turns[0])
    assert loaded.document["correction"]["files"] == ["few.csv"]
    assert loaded.document["correction"]["onto"] != first
    features = np.array([[520.0, 500.0]])
    plain = nine.model.predict(features, {})
    now = 2.0 * (2.0 * features + [1.0, 0.0]) + [0.25, 0.0]
    assert loaded.predict(now) == pytest.approx(plain @ (turns[1] @ turns[0]).T)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": "another"}, "expected a document of sun-sensor-atlas/sensor-calibration"),
        ({"schema_version": 99}, "expected version 1 or 2; got 99"),
    ],
)
def test_a_document_of_another_kind_is_refused(
    change: dict[str, object], said: str, nine: Calibration, tmp_path: Path
) -> None:
    file = tmp_path / "nine.json"
    file.write_text(json.dumps(documents.document(nine) | change), encoding="utf-8")
    with pytest.raises(UnreadableCalibrationError, match=rf"^nine\.json: {said}"):
        load(file)
