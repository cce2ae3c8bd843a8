"""A running service takes on what a command beside it has found out."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from fastapi import FastAPI

from api.http.server.renewal import Renewed, renewed_after


def saying(word):
    app = FastAPI()
    app.get("/")(lambda: word)
    return app


def test_requests_go_to_the_newest_application(client_of):
    service = Renewed(saying("first"))
    client = client_of(service)
    assert client.get("/").json() == "first"
    with renewed_after([sys.executable, "-c", ""], service, lambda: saying("second")) as waiting:
        waiting.join()
        assert client.get("/").json() == "second"


def test_a_command_that_fails_changes_nothing(client_of):
    service = Renewed(saying("first"))
    command = [sys.executable, "-c", "raise SystemExit(3)"]
    with renewed_after(command, service, lambda: saying("second")) as waiting:
        waiting.join()
    assert client_of(service).get("/").json() == "first"


def test_the_command_ends_with_the_service(tmp_path):
    service = Renewed(saying("first"))
    started = tmp_path / "started"
    code = f"import pathlib, time; pathlib.Path({str(started)!r}).touch(); time.sleep(600)"
    with renewed_after([sys.executable, "-c", code], service, lambda: saying("second")) as waiting:
        while not started.exists():
            time.sleep(0.01)
        assert waiting.is_alive()
    assert not waiting.is_alive()


def test_a_command_that_cannot_start_is_an_error():
    with (
        pytest.raises(FileNotFoundError),
        renewed_after(["no-such-command"], Renewed(saying("first")), subprocess.run),
    ):
        pass


SERVICE = """
import sys, time
from api.http.server.renewal import Renewed, renewed_after
writing = "import os, time; open('pid', 'w').write(str(os.getpid())); time.sleep(600)"
command = sys.executable, "-c", writing
with renewed_after(command, Renewed(None), lambda: None):
    time.sleep(600)
"""


@pytest.mark.skipif(not Path("/proc").exists(), reason="asks /proc whether a process lives")
def test_a_service_that_is_told_to_terminate_takes_its_command_along(tmp_path):
    service = subprocess.Popen([sys.executable, "-c", SERVICE], cwd=tmp_path, env=_with_path())
    found = tmp_path / "pid"
    while not (found.exists() and found.read_text()):
        assert service.poll() is None
        time.sleep(0.05)
    service.send_signal(signal.SIGTERM)
    assert service.wait() == 128 + signal.SIGTERM
    assert not Path("/proc", found.read_text()).exists()


def _with_path():
    return {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[3])}
