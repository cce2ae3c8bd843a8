"""A running service takes on what a command beside it has found out."""

import subprocess
import sys
import time

import pytest
from fastapi import FastAPI

from api.http.renewal import Renewed, renewed_after


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
