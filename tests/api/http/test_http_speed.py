"""What `make bench` asks the service, and its verdict; nothing is timed here."""

import itertools
import json

from tools.bench import service as speed


def test_queries_that_are_to_differ_do(atlas):
    for kind in (speed.exclusion_paths(), speed.limit_paths(), speed.random_paths(1)):
        paths = list(itertools.islice(kind, 500))
        assert len(set(paths)) == 500
        answers = [atlas.get(path) for path in paths[:3]]
        assert all(answer.status_code == 200 for answer in answers)
    broad = atlas.get(next(speed.exclusion_paths())).json()
    assert broad["count"] > 20
    assert broad["designs"] > 200


def test_the_command_prints_ratios_and_its_exit_status_tells(monkeypatch, capsys):
    rounds = [[(100.0, 200.0), (110.0, 250.0)], [(300.0, 2000.0)], [(100.0, 200.0)]]
    kept = speed.summary("repeated", rounds)
    assert (kept.empty_us, kept.recommendation_us) == (105.0, 225.0)
    assert (kept.ratio, kept.mean_ratio, kept.dear_ratio) == (225 / 105, 2650 / 610, 2000 / 105)
    broken = speed.summary("excluding", [[(100.0, 510.0)]])
    monkeypatch.setattr(speed, "measure", lambda *_: [kept])
    assert speed.main(["--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["kept"] is True
    monkeypatch.setattr(speed, "measure", lambda *_: [kept, broken])
    assert speed.main([]) == 1
    assert "5.10" in capsys.readouterr().out
