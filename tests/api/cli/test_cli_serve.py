"""`sunatlas serve`: a port of its own, a URL to open, a clean end."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest
import uvicorn
from typer.testing import CliRunner

from api.cli import asking
from api.cli.command_line import app
from api.cli.commands.serve import address, listen
from files import manifest
from registry import studies
from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY

ROOT = Path(__file__).resolve().parents[3]


@contextmanager
def serving(*options, **popen):
    """`sunatlas serve` in a process of its own, and the URL that it prints."""
    with subprocess.Popen(
        [sys.executable, "-m", "api.cli.command_line", "serve", "--port", "0", *options],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **popen,
    ) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().split()[3]
        finally:
            process.kill()


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_serve_prints_where_it_answers_and_ends_with_the_code_of_the_signal(number, code):
    # tests started in a shell's background ignore interrupts, and what they start does too
    heeding = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with serving(preexec_fn=heeding) as (process, url):
        with urllib.request.urlopen(f"{url}/healthz", timeout=600) as answer:
            health = json.load(answer)
        process.send_signal(number)
        _, said = process.communicate(timeout=600)
    assert health["status"] == "ok"
    assert health["studies"] == 129
    assert process.returncode == code
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


def running(group):
    """Command lines of a group's processes; zombies, which nobody has reaped, do not run."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, of_group = stat.read_text().rpartition(")")[2].split()[:3]
            if int(of_group) == group and state != "Z":
                found.append(stat.with_name("cmdline").read_text())
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("workers", "code", "says"), [(1, 143, "interrupted\n"), (2, 0, "")])
def test_an_answer_on_its_way_does_not_hold_up_the_end(workers, code, says):
    """A calibration takes seconds in a thread, which nothing can interrupt."""
    row = b"%d,%d,%d,%d\n"
    grid = [(x, y) for x in range(-40, 41, 10) for y in range(-40, 41, 10)]
    rows = b"".join(row % (512 + 6 * x, 512 + 6 * y, x, y) for x, y in grid)
    body = (
        b'--a\r\nContent-Disposition: form-data; name="file"; filename="b.csv"\r\n\r\n'
        b"x_px,y_px,theta_x_deg,theta_y_deg\n" + rows + b"\r\n--a--\r\n"
    )
    head = (
        b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nContent-Length: %d\r\n"
        b"Content-Type: multipart/form-data; boundary=a\r\n\r\n" % len(body)
    )
    with serving("--workers", str(workers), start_new_session=True) as (process, url):
        urllib.request.urlopen(f"{url}/healthz", timeout=600).close()
        with socket.create_connection(url.removeprefix("http://").split(":")) as plug:
            plug.sendall(head + body)
            time.sleep(0.5)  # it is being calibrated
            process.send_signal(signal.SIGTERM)
            _, said = process.communicate(timeout=600)
            assert not plug.recv(1), "no answer, whole or half"
    assert (process.returncode, said) == (code, says)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are read from /proc")
def test_workers_add_up_their_counts_and_leave_nothing_behind(tmp_path):
    options, own = ("--workers", "2", "--access-log"), {**os.environ, "TMPDIR": str(tmp_path)}
    with serving(*options, env=own, start_new_session=True) as (process, url):
        for _ in range(40):
            with urllib.request.urlopen(f"{url}/v1/taxonomy", timeout=600) as answer:
                assert answer.status == 200
        with urllib.request.urlopen(f"{url}/metrics", timeout=600) as answer:
            text = answer.read().decode()
        process.send_signal(signal.SIGTERM)
        out, said = process.communicate(timeout=600)
    wanted = re.compile(r"sunatlas_http_requests_total\{.*taxonomy.*\} 40\.0")
    assert wanted.search(text)
    assert out.count('"GET /v1/taxonomy HTTP/1.1" 200') == 40
    assert (process.returncode, said) == (0, "")
    assert not list(tmp_path.iterdir())
    deadline = time.monotonic() + 60  # Python's resource tracker notices by itself
    while left := running(process.pid):
        assert time.monotonic() < deadline, left
        time.sleep(0.05)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are read from /proc")
def test_a_reload_replaces_both_workers_and_every_question_meanwhile_is_answered():
    def workers():
        found = set()
        for child in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            with suppress(FileNotFoundError):  # it has just ended
                if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text():
                    found.add(child)
        return found

    with serving("--workers", "2", start_new_session=True) as (process, url):
        urllib.request.urlopen(f"{url}/healthz", timeout=600).close()
        first = workers()
        assert len(first) == 2
        process.send_signal(signal.SIGHUP)
        while first & (now := workers()) or len(now) < 2:
            with urllib.request.urlopen(f"{url}/v1/taxonomy", timeout=600) as answer:
                assert answer.status == 200
    deadline = time.monotonic() + 60
    while running(process.pid):
        assert time.monotonic() < deadline, "workers outlive the process that started them"
        time.sleep(0.1)


@pytest.mark.slow
def test_damaged_facts_are_refused_in_one_line_before_anything_is_served(monkeypatch, tmp_path):
    for name in (*facts_manifest.names(), manifest.FILE):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(DATA_DIRECTORY / name, tmp_path / name)
    path = tmp_path / "attributes.csv"
    path.write_text(path.read_text().replace("accuracy_deg,0", "accuracy_deg,0x1", 1))
    monkeypatch.setattr(facts_manifest.changes, "__defaults__", (tmp_path,))
    monkeypatch.setattr(facts_manifest.require_unchanged, "__defaults__", (tmp_path,))
    monkeypatch.setattr(uvicorn.Server, "run", lambda *_, **__: pytest.fail("it serves"))
    monkeypatch.setattr(studies, "_facts", studies._facts.__wrapped__)
    monkeypatch.setattr(asking, "knowledge", asking.knowledge.__wrapped__)
    for command in (["serve", "--port", "0"], ["studies"], ["recommend"]):
        shown = CliRunner().invoke(app, command)
        assert shown.exit_code == 1
        assert shown.stdout == ""
        assert shown.stderr.count("\n") == 1
        assert "attributes.csv: SHA-256 is " in shown.stderr
