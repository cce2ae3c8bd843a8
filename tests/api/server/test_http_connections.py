"""Over real sockets: half requests are closed in time, too many get a time to retry."""

import json
import socket
import time
from contextlib import ExitStack

import pytest

from api.server.connections import BoundedProtocol


class Impatient(BoundedProtocol):
    arrives_s = 0.1


class Prompt(BoundedProtocol):
    arrives_s = 0.4


class Unread(BoundedProtocol):
    reads_s = 0.5


class Small(BoundedProtocol):
    most_connections = 5


@pytest.fixture(scope="module")
def place(atlas, request, serve):
    # what the application answers is loaded with its first answer, not once more by every server
    with serve(atlas.app, http=request.param) as connection:
        yield connection.host, connection.port


def answer(plug):
    """All that comes until the other side closes."""
    plug.settimeout(60)
    received = b""
    while data := plug.recv(65536):
        received += data
    return received


def dial(place, stack):
    return stack.enter_context(socket.create_connection(place, timeout=60))


@pytest.mark.parametrize(
    ("place", "sent", "status"),
    [
        (Impatient, b"", b"408"),
        (Impatient, b"GET /healthz HT", b"408"),
        (Impatient, b"GET /healthz HTTP/1.1\r\nHost: a\r\nX-Slow: ", b"408"),
        (
            Prompt,  # its header is to arrive in time
            (
                b"POST /v1/recommendations HTTP/1.1\r\nHost: a\r\n"
                b"Content-Type: application/json\r\nContent-Length: 50\r\n\r\n{"
            ),
            None,
        ),
    ],
    indirect=["place"],
)
def test_half_a_request_is_closed(place, sent, status):
    with ExitStack() as stack:
        plug = dial(place, stack)
        plug.sendall(sent)
        received = answer(plug)
    if status is None:
        assert received == b""  # it had its chance to send the rest
    else:
        head, _, body = received.partition(b"\r\n\r\n")
        assert head.split(b" ")[1] == status
        assert b"connection: close" in head.lower()
        assert json.loads(body)["type"].endswith(":request-timeout")


@pytest.mark.parametrize("place", [Impatient], indirect=True)
def test_bytes_that_trickle_in_do_not_prolong_it(place):
    with ExitStack() as stack:
        plug = dial(place, stack)
        plug.settimeout(60)
        start = time.monotonic()
        received = b""
        for letter in b"GET /" + b"a" * 5000:
            try:
                plug.sendall(bytes([letter]))
            except OSError:
                break
            plug.settimeout(0.02)
            try:
                received = plug.recv(4096)
            except TimeoutError:
                continue
            break
        assert b" 408 " in received
        assert time.monotonic() - start < 50  # 5,000 letters would take 100 s


@pytest.mark.parametrize("place", [Prompt], indirect=True)
def test_a_kept_connection_is_not_closed_for_having_been_slow_before(place):
    whole = b"GET /healthz HTTP/1.1\r\nHost: a\r\n\r\n"
    with ExitStack() as stack:
        plug = dial(place, stack)
        for _ in range(2):
            plug.sendall(whole)
            received = b""
            while not received.endswith(b"}"):
                received += plug.recv(65536)
            assert b" 200 " in received.partition(b"\r\n")[0]
            time.sleep(0.45)  # longer than a request may take: nothing is on its way


@pytest.mark.parametrize("place", [Small], indirect=True)
def test_too_many_connections_are_told_when_to_come_back(place):
    whole = b"GET /v1/taxonomy HTTP/1.1\r\nHost: a\r\n\r\n"
    with ExitStack() as stack:
        held = [dial(place, stack) for _ in range(6)]
        for plug in held[:-1]:
            plug.sendall(b"GET")  # accepted for certain once the last one is answered
        held[-1].sendall(whole)
        head, _, body = answer(held[-1]).partition(b"\r\n\r\n")
        assert b" 503 " in head
        assert b"retry-after: 2" in head.lower()
        assert json.loads(body)["type"].endswith(":overloaded")
        for plug in held:
            plug.close()
    with ExitStack() as stack:
        for _ in range(200):  # until the server has seen them go
            plug = dial(place, stack)
            plug.sendall(whole.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))
            if b" 200 " in answer(plug).partition(b"\r\n")[0]:
                return
            time.sleep(0.02)
    pytest.fail("it never answers again")


@pytest.mark.parametrize("place", [BoundedProtocol], indirect=True)
def test_who_has_said_all_and_hangs_up_one_way_is_answered(place):
    whole = b"GET /v1/recommendations?limit=1 HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
    for _ in range(5):
        with ExitStack() as stack:
            plug = dial(place, stack)
            plug.sendall(whole)
            plug.shutdown(socket.SHUT_WR)
            assert answer(plug).startswith(b"HTTP/1.1 200 ")


POST = (
    "POST /v1/recommendations HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
    "{more}Content-Length: {length}\r\n\r\n"
)


@pytest.mark.parametrize("place", [BoundedProtocol], indirect=True)
@pytest.mark.parametrize("more", ["", "Connection: close\r\n"])
def test_the_refusal_of_a_long_body_arrives(place, more):
    length = 8_000_000
    with ExitStack() as stack:
        plug = dial(place, stack)
        plug.sendall(POST.format(length=length, more=more).encode())
        plug.sendall(b" " * length)
        plug.shutdown(socket.SHUT_WR)
        head, _, body = answer(plug).partition(b"\r\n\r\n")
    assert b" 413 " in head
    assert json.loads(body)["type"].endswith(":content-too-large")


@pytest.mark.parametrize("place", [BoundedProtocol], indirect=True)
def test_who_asks_before_sending_is_refused_before(place):
    with ExitStack() as stack:
        plug = dial(place, stack)
        more = "Expect: 100-continue\r\n"
        plug.sendall(POST.format(length=10**9, more=more).encode())
        received = answer(plug)
    assert received.startswith(b"HTTP/1.1 413 ")


PIPELINED = b"GET /v1/results?limit=500 HTTP/1.1\r\nHost: a\r\n\r\n" * 100


def closed_within(plug, seconds):
    """Whether the other side has let go: what is sent to it is refused."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            plug.send(b"GET")
        except BlockingIOError:
            pass
        except ConnectionError:
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize("place", [Unread], indirect=True)
def test_who_reads_nothing_is_closed_and_who_reads_is_not(place):
    with ExitStack() as stack:
        for_nothing = [dial(place, stack) for _ in range(4)]
        for plug in for_nothing:
            plug.setblocking(False)
            plug.send(PIPELINED)
        reading = dial(place, stack)
        reading.sendall(PIPELINED)
        received = 0
        start = time.monotonic()
        # Slowly, a part at a time, for longer than nothing may be read.
        while received <= 500_000 or time.monotonic() - start < 2 * Unread.reads_s:
            part = reading.recv(50_000)
            assert part
            received += len(part)
            time.sleep(0.05)
        assert all(closed_within(plug, 20.0) for plug in for_nothing)
        assert reading.recv(50_000)
