"""A bundle from a wheel, away from the checkout: the same bytes."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.api.deposit.conftest import FRAMES
from tests.api.deposit.test_deposit import files

ROOT = Path(__file__).resolve().parents[3]
BUILD = """
import sys
from pathlib import Path
from api.deposit.bundle import build
print(Path(sys.modules["api"].__file__).parent)
build(Path(sys.argv[1]), code=Path(sys.argv[2]), frames=sys.argv[3:])
"""


@pytest.mark.slow
def test_a_wheel_builds_the_bytes_that_a_checkout_builds(built, tmp_path):
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q"]
    subprocess.run([*command, "-w", str(tmp_path), str(ROOT)], check=True, timeout=300)
    (wheel,) = tmp_path.glob("*.whl")
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(site)
    environment = {**os.environ, "PYTHONPATH": str(site), "PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo"}
    out, code = tmp_path / "bundle", (built.directory / "code").iterdir()
    shown = subprocess.run(
        [sys.executable, "-c", BUILD, str(out), str(next(code)), *FRAMES],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
    )
    assert shown.returncode == 0, shown.stderr
    assert shown.stdout.strip() == str(site / "api")
    ours, theirs = files(built.directory), files(out)
    assert [name for name in ours | theirs if ours.get(name) != theirs.get(name)] == []
    assert out.with_name("bundle.zip").read_bytes() == built.archive.read_bytes()
