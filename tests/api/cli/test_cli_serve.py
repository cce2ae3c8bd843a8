"""`sunatlas serve`: a port of its own, a URL to open, a clean end."""

import json
import signal
import socket
import subprocess
import sys
import urllib.request
from functools import partial
from pathlib import Path

import pytest
import uvicorn
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.commands.serve import address, listen

ROOT = Path(__file__).resolve().parents[3]
SERVE = (sys.executable, "-m", "api.cli.command_line", "serve")


@pytest.mark.slow
def test_serve_prints_where_it_answers_and_ctrl_c_ends_it_with_130():
    with subprocess.Popen(
        [*SERVE, "--port", "0"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # tests started in a shell's background ignore interrupts, and what they start does too
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - one thread
    ) as process:
        try:
            assert process.stdout is not None
            url = process.stdout.readline().split()[3]
            with urllib.request.urlopen(f"{url}/healthz", timeout=600) as answer:
                health = json.load(answer)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=600)
        finally:
            process.kill()
    assert health["status"] == "ok"
    assert health["studies"] == 129
    assert process.returncode == 130
    assert "Traceback" not in said


def test_a_port_that_is_taken_is_refused_in_one_line(monkeypatch):
    monkeypatch.setattr(uvicorn.Server, "run", lambda *_, **__: pytest.fail("it serves"))
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        shown = CliRunner().invoke(app, ["serve", "--port", port])
    assert shown.exit_code == 1
    assert shown.stdout == ""
    assert shown.stderr.count("\n") == 1
    assert port in shown.stderr
    assert "--port" in shown.stderr


def test_an_address_that_is_none_is_refused():
    with pytest.raises(OSError, match="no address named 'not a host'"):
        listen("not a host", 0)


@pytest.mark.parametrize(
    ("host", "url"),
    [
        ("127.0.0.1", "http://127.0.0.1:80"),
        ("0.0.0.0", "http://127.0.0.1:80"),
        ("::", "http://[::1]:80"),
        ("sensor.example", "http://sensor.example:80"),
    ],
)
def test_the_url_is_one_a_browser_opens(host, url):
    assert address(host, 80) == url
