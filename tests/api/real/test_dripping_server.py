"""A server that never ends its answer is given up, and what it says cannot command a terminal."""

import threading

import pytest

from api.cli.command_line import _stop
from api.real import fetching
from api.real.fetching import FetchError, fetch
from api.real.sets import SETS


def test_an_answer_that_never_ends_is_given_up(monkeypatch, tmp_path):
    ended = threading.Event()

    class Dripping:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def read(self, _):
            ended.wait(600)  # each byte comes before the socket's own time is over
            return b""

    monkeypatch.setattr(fetching, "urlopen", lambda *_, **__: Dripping())
    monkeypatch.setattr(fetching, "_LONGEST_S", 0.1)
    with pytest.raises(FetchError, match=r"expected a whole answer within 0\.1 s"):
        fetch(SETS["cubesatbox"], tmp_path / "out")
    assert not (tmp_path / "out").exists()
    ended.set()


def test_what_a_terminal_obeys_is_shown_escaped(capsys):
    with pytest.raises(SystemExit):
        _stop(FetchError(), 1, "404 \x1b[31mred\x07 \x9b \u202e 5\u00b0 \udcff")
    said = capsys.readouterr().err
    assert said == "sunatlas: 404 \\x1b[31mred\\x07 \\x9b \\u202e 5\u00b0 \\udcff\n"
