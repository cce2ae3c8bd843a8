"""A process that is killed while it uploads: the next one goes on where it was."""

import os
import signal
import subprocess
import sys

import pytest

from tests.api.deposit.standins.server import TOKEN


def command(journey, *arguments):
    environment = {**os.environ, "ARCHIVE_TOKEN": TOKEN, "NO_PROXY": "*"}
    return subprocess.Popen(
        [
            *(sys.executable, "-m", "api.cli.command_line", "deposit", *arguments),
            *("--bundle", str(journey.bundle), "--api", journey.api),
            *("--server", journey.archive.address),
        ],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_killed_upload_goes_on_without_sending_a_finished_file_again(journey, end):
    held = journey.fails("hold", "send", times=0)
    # The third file hangs, with two finished before it.
    count = {"sent": 0}
    step = held.at

    def third(method, path):
        if not step(method, path):
            return False
        count["sent"] += 1
        return count["sent"] == 3

    held.at, held.times = third, 1
    first = command(journey, "upload")
    assert held.met.wait(120)
    first.send_signal(end)
    out, err = first.communicate(timeout=60)
    assert first.returncode != 0
    assert TOKEN not in out + err
    held.released.set()
    finished = [line.removeprefix("sent: ") for line in err.splitlines() if "sent: " in line]
    assert len(finished) == 2
    (draft,) = journey.archive.drafts

    second = command(journey, "upload", "--format", "json")
    out, err = second.communicate(timeout=120)
    assert second.returncode == 0, err
    assert TOKEN not in out + err
    assert list(journey.archive.drafts) == [draft]
    assert journey.archive.held(draft) == journey.wanted()
    assert {name: journey.sent()[name] for name in finished} == dict.fromkeys(finished, 1)
    assert not journey.archive.records
    assert not journey.archive.calls("POST", "/actions/publish")

    third_run = command(journey, "publish", draft)
    out, err = third_run.communicate(timeout=120)
    assert third_run.returncode == 0, err
    assert set(journey.archive.records) == {draft}
    assert "published" in out
