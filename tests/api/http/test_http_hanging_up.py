"""Who hangs up gives the place in the queue of calibrations away; others wait for theirs."""

import asyncio
import contextlib
import gc
import json
import logging
import os
import select
import socket
import struct
import tempfile
import threading
import time
import weakref

import pytest
from starlette.datastructures import UploadFile

from api.service import calibrations
from calibrate.uploaded import UploadRefusedError

BODY = b'--a\r\nContent-Disposition: form-data; name="file"; filename="b.csv"\r\n\r\n1\r\n--a--\r\n'
HEAD = (
    b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nContent-Length: %d\r\n"
    b"Content-Type: multipart/form-data; boundary=a\r\n\r\n" % len(BODY)
)


@pytest.fixture
def work(monkeypatch):
    """Calibrations that begin, and end when their caller hangs up."""
    begun = threading.Semaphore(0)

    def calibrate(*_, caller, **__):
        begun.release()
        assert os.read(caller.end, 1) == b""
        caller.close()
        raise UploadRefusedError("nobody waits")

    monkeypatch.setattr(calibrations, "calibrate_uploads", calibrate)
    return begun


def waiting(count):
    """Wait until so many calibrations run or wait."""
    deadline = time.monotonic() + 60
    while calibrations._CALIBRATIONS.length != count:
        assert time.monotonic() < deadline, calibrations._CALIBRATIONS.length
        time.sleep(0.01)


def left(connection):
    connection.request("GET", "/metrics")
    text = connection.getresponse().read().decode()
    lines = [line for line in text.splitlines() if "_total{" in line and 'status="499"' in line]
    return sum(float(line.rpartition(" ")[2]) for line in lines)


def test_who_hangs_up_gives_the_turn_to_the_next(atlas, serve, work):
    with serve(atlas.app) as connection:
        before = left(connection)
        plugs = []
        for _ in range(3):
            plugs.append(socket.create_connection((connection.host, connection.port)))
            plugs[-1].sendall(HEAD + BODY)
            waiting(len(plugs))
        assert work.acquire(timeout=60)
        assert not work.acquire(blocking=False), "one at a time"
        plugs[1].close()  # before its turn
        waiting(2)
        plugs[0].close()
        assert work.acquire(timeout=60), "the third"
        plugs[2].close()
        waiting(0)
        assert not work.acquire(blocking=False)
        assert left(connection) == before + 3


def test_who_waits_is_told_by_any_worker_how_many_come_first(
    atlas, serve, work, tmp_path, monkeypatch
):
    """Another process of the server has a queue of its own, which is not counted."""
    monkeypatch.setenv(calibrations.SHARED, str(tmp_path))
    for name in ("1-000000000000-", "1-000000000001-" + 16 * "9", "1-000000000002-"):
        (tmp_path / name).touch()

    def told(ticket):
        connection.request("GET", f"/v1/calibrations/waiting/{ticket:016}")
        answer = connection.getresponse()
        assert answer.headers["Cache-Control"] == "no-store"
        return json.loads(answer.read())

    with serve(atlas.app) as connection, contextlib.ExitStack() as plugs:
        for number in range(3):
            field = b'--a\r\nContent-Disposition: form-data; name="ticket"\r\n\r\n'
            body = field + b"%016d\r\n" % number + BODY
            place = (connection.host, connection.port)
            plug = plugs.enter_context(socket.create_connection(place))
            plug.sendall(HEAD.replace(b"%d" % len(BODY), b"%d" % len(body)) + body)
            waiting(number + 1)
        assert [told(n) for n in range(3)] == [{"before": n, "wait_s": 10 * n} for n in range(3)]
        assert told(9999999999999999) == {"before": 1, "wait_s": 10}
        plug.close()
        waiting(2)
        assert told(2) == {"before": None, "wait_s": None}
        connection.request("GET", "/v1/calibrations/waiting/*")
        assert json.loads(connection.getresponse().read()) == {"before": None, "wait_s": None}
    waiting(0)
    assert len(list(tmp_path.iterdir())) == 3, "notes of calibrations that are over are gone"


@pytest.mark.parametrize("path", [b"/v1/calibrations", b"/v1/calibrations/preview", b"/calibrate"])
def test_a_hundred_uploads_that_are_cut_leave_no_line_no_file_and_no_place_taken(
    *, atlas, serve, work, path, tmp_path, monkeypatch, caplog
):
    """Cut in the head, in a part, in a file that is on disk, at the end; by a reset or a close."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(calibrations, "preview_uploads", calibrations.calibrate_uploads)
    body = BODY.replace(b"\r\n\r\n1", b"\r\n\r\n" + b"1" * 1_200_000)
    head = HEAD.replace(b"/v1/calibrations", path).replace(b"%d" % len(BODY), b"%d" % len(body))
    cuts = (0, 30, 5000, 1_100_000, len(body) - 3, len(body))
    with caplog.at_level(logging.WARNING), serve(atlas.app) as connection:
        before = left(connection)
        for number in range(100):
            with socket.create_connection((connection.host, connection.port)) as plug:
                plug.sendall(head + body[: cuts[number % len(cuts)]])
                if number % 2:
                    plug.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        deadline = time.monotonic() + 60
        while (count := left(connection)) < before + 100:
            assert time.monotonic() < deadline, count - before
            time.sleep(0.05)
        waiting(0)
    assert caplog.records == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["/v1/calibrations", "/v1/calibrations/preview", "/calibrate"])
def test_files_that_are_refused_are_let_go_at_once(atlas, path, monkeypatch):
    """Held by a cycle, nine of 10 MB waited for a walk of the collector, which comes seldom."""
    sent = []

    def refuse(files, *_, **__):
        sent.extend(map(weakref.ref, files))
        raise UploadRefusedError("no")

    monkeypatch.setattr(calibrations, "calibrate_uploads", refuse)
    monkeypatch.setattr(calibrations, "preview_uploads", refuse)
    gc.disable()
    try:
        assert atlas.post(path, files={"file": ("b.csv", b"1")}).status_code == 422
        # the thread that answered may still be leaving its frames
        for _ in range(500):
            if [one() for one in sent] == [None]:
                break
            time.sleep(0.01)
        assert [one() for one in sent] == [None]
    finally:
        gc.enable()


def test_files_of_many_forms_are_not_in_memory_at_once(atlas, serve, work, monkeypatch):
    """400 of 9.9 MB that ended together took a process to 3 GB before 391 heard 503."""
    monkeypatch.setattr(calibrations, "MOST_WAITING", 2)
    read, held = UploadFile.read, []

    async def slowly(part, *size):
        held.append(part)
        await asyncio.sleep(0.02)
        return await read(part, *size)

    monkeypatch.setattr(UploadFile, "read", slowly)
    with serve(atlas.app) as connection, contextlib.ExitStack() as plugs:
        place = (connection.host, connection.port)
        opened = [plugs.enter_context(socket.create_connection(place)) for _ in range(30)]
        for plug in opened:
            plug.sendall(HEAD + BODY[:-1])
        for plug in opened:
            plug.sendall(BODY[-1:])
        refused = 0
        while refused < 27:
            for plug in select.select(opened, (), (), 60)[0]:
                assert plug.recv(65536).startswith(b"HTTP/1.1 503 ")
                opened.remove(plug)
                refused += 1
        assert len(held) == 3
    waiting(0)
