"""The unit for systemd: little of the machine is exposed, and a reload drops no answer."""

import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from api.cli.commands.serve import inherited

ROOT = Path(__file__).resolve().parents[3]
UNIT = ROOT / "deploy" / "sunatlas.service"


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd-analyze here")
def test_the_exposure_of_the_unit_is_below_1_5():
    command = ["systemd-analyze", "security", "--offline=true", "--no-pager", UNIT]
    said = subprocess.run(command, check=False, capture_output=True, text=True).stdout
    found = re.search(r"exposure level for \S+ ([\d.]+)", said)
    assert found is not None, said
    assert float(found[1]) < 1.5


def test_the_unit_reloads_by_the_signal_that_replaces_workers_and_keeps_its_socket():
    text = UNIT.read_text()
    assert "ExecReload=/bin/kill -HUP $MAINPID" in text
    assert "Requires=sunatlas.socket" in text
    assert "ListenStream=127.0.0.1:8000" in UNIT.with_suffix(".socket").read_text()


_HANDED = """
import os, sys
os.dup2(int(sys.argv[1]), 3)
os.environ |= {"LISTEN_PID": str(os.getpid()), "LISTEN_FDS": "1"}
from api.cli.commands.serve import inherited
print(inherited().getsockname()[1], "LISTEN_PID" in os.environ)
"""


def test_a_socket_that_is_handed_over_is_served_and_no_worker_takes_it_for_its_own(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        number = listener.fileno()
        command = [sys.executable, "-c", _HANDED, str(number)]
        done = subprocess.run(
            command, cwd=ROOT, pass_fds=[number], check=True, capture_output=True, text=True
        )
        assert done.stdout.split() == [str(listener.getsockname()[1]), "False"]
    monkeypatch.setenv("LISTEN_PID", str(os.getpid() + 1))
    monkeypatch.setenv("LISTEN_FDS", "1")
    assert inherited() is None, "handed to another process"
