"""Generated parts in git are what the code says now, and are renewed by name."""

from __future__ import annotations

from pathlib import Path

import pytest

from api.cli.asking import knowledge
from api.docs import documentation, front
from api.docs.documentation import regenerate, renew_parts
from benchmark.leaderboard.architectures import architectures

PAGE = "prose\n<!-- generated: one -->\nold\n<!-- end: one -->\nmore prose\n"


@pytest.mark.slow
def test_the_committed_docs_are_current() -> None:
    assert regenerate(write=False) == [], "run `make docs`"


def test_what_is_altered_is_noticed_and_renewed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(documentation, "PAGES", {"page.md": {"one": lambda: "new"}})
    monkeypatch.setattr(documentation, "WHOLE", {"made.svg": lambda: "<svg/>"})
    monkeypatch.setattr(documentation, "RUN", ("run.md",))
    monkeypatch.setattr(documentation, "ROOT", tmp_path)
    (tmp_path / "page.md").write_text(PAGE)
    (tmp_path / "run.md").write_text("```python\nprint(2)\n```\n\n```text\n1\n```\n")
    assert documentation.main(["--check"]) == 1
    said = capsys.readouterr().err
    for name in ("page.md", "made.svg", "run.md"):
        assert f"{name} is behind" in said
    assert (tmp_path / "page.md").read_text() == PAGE
    assert documentation.main([]) == 0
    assert "\nnew\n" in (tmp_path / "page.md").read_text()
    assert "text\n2\n" in (tmp_path / "run.md").read_text()
    assert documentation.main(["--check"]) == 0


@pytest.mark.parametrize(
    ("text", "parts"), [(PAGE, ("two",)), (PAGE, ("one", "two")), (PAGE, ()), (PAGE * 2, ("one",))]
)
def test_a_part_that_is_missing_unknown_or_there_twice_is_named(
    text: str, parts: tuple[str, ...]
) -> None:
    with pytest.raises(ValueError, match=r"page\.md: expected"):
        renew_parts("page.md", text, {name: lambda: "" for name in parts})


def test_the_front_picture_has_a_line_for_each_architecture_with_an_error() -> None:
    rows = architectures(knowledge().measurements.leaderboard)
    (axes,) = front.figure().axes
    ends = [line.get_xdata() for line in axes.lines if line.get_linestyle() == "-"]
    flown = [row for row in rows if row["own_error_deg"] is not None]
    assert len(flown) > 20
    assert sorted(map(tuple, ends)) == sorted(
        (one["bound_deg"], one["own_error_deg"], one["flight_error_deg"] or one["own_error_deg"])
        for one in flown
    )
