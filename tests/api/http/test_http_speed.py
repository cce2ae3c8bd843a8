"""What `make bench` asks the service, and its verdict; nothing is judged by its time here."""

import itertools

from tools.bench import service as speed
from tools.bench.verdicts import Verdict


def test_drawn_questions_differ_and_are_answered(atlas):
    paths = list(itertools.islice(speed.random_paths(1), 300))
    assert len(set(paths)) == 300
    assert all(atlas.get(path).status_code == 200 for path in paths[:10])


def test_every_figure_is_measured_and_a_broken_limit_is_the_exit_status(monkeypatch, capsys):
    found = speed.measure(3, questions=3)
    assert len(found) == 5
    assert all(verdict.value > 0 for verdict in found)
    monkeypatch.setattr(speed, "measure", lambda _: [Verdict("a size", 1.0, 2.0)])
    assert speed.main([]) == 0
    monkeypatch.setattr(speed, "measure", lambda _: [Verdict("a size", 3.0, 2.0)])
    assert speed.main([]) == 1
    assert "a size: 3 (at most 2)" in capsys.readouterr().out
