"""`sunatlas dataset fetch` lists, refuses and writes."""

from __future__ import annotations

import pytest
import typer

from api.cli.commands.dataset import app
from api.cli.wrong_call import WrongCallError
from api.real import fetching


def test_sets_are_listed_fetched_and_refused_by_name(monkeypatch, tmp_path, capsys):
    command = typer.main.get_command(app)
    command.main(["fetch"], standalone_mode=False)
    assert "cubesatbox" in capsys.readouterr().out
    with pytest.raises(WrongCallError, match="no set of real readings"):
        command.main(["fetch", "cubesatbx"], standalone_mode=False)
    with pytest.raises(WrongCallError, match="cubesatbox"):
        command.main(["fetch", "--scores"], standalone_mode=False)
    monkeypatch.setattr(fetching, "_download", lambda address: b"another file")
    out = tmp_path / "box"
    with pytest.raises(fetching.FetchError, match="expected SHA-256"):
        command.main(["fetch", "cubesatbox", "--out", str(out)], standalone_mode=False)
    assert not out.exists()
