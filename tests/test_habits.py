"""Habits that files of the repository state: commit subjects, lock files, pinned actions."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from tools import commit_subject, prose, sizes
from tools.bench.paired import OverLimitError, at_most, ratio
from tools.lock_beyond import PIN, beyond

ROOT = Path(__file__).parents[1]
LOCKS = {path.name: path.read_text("utf-8") for path in ROOT.glob("requirements*.lock")}


@pytest.mark.parametrize(
    "subject",
    [
        "store: refuse a second writer",
        "files, docs: write each file whole",
        "http: address slow clients",
        "Merge branch 'main' of elsewhere",
        'Revert "store: refuse a second writer"',
        "fixup! store: refuse a second writer",
        "a: " + "b" * 69,
    ],
)
def test_a_subject_of_the_form_passes(subject: str) -> None:
    assert commit_subject.faults(subject) == []


@pytest.mark.parametrize(
    ("subject", "fault"),
    [
        ("Refuse a second writer", "expected `area: imperative`"),
        ("", "expected `area: imperative`"),
        ("store: ", "expected `area: imperative`"),
        ("store: refuse a second writer.", "no full stop"),
        ("store: refused a second writer", "a past tense"),
        ("store: refuses a second writer", "a third person"),
        ("store: refusing a second writer", "a participle"),
        ("a: " + "b" * 70, "73 characters; at most 72"),
    ],
)
def test_a_subject_of_another_form_is_refused(subject: str, fault: str, tmp_path: Path) -> None:
    assert any(fault in found for found in commit_subject.faults(subject))
    message = tmp_path / "COMMIT_EDITMSG"
    message.write_text(f"{subject}\n\nWhy.\n")
    assert commit_subject.main([str(message)]) == 1


def test_only_the_first_line_of_a_message_is_judged(tmp_path: Path) -> None:
    message = tmp_path / "COMMIT_EDITMSG"
    message.write_text("# what git says\nstore: refuse a second writer\n\nIt lost rows.\n")
    assert commit_subject.main([str(message)]) == 0


def test_every_pin_has_a_hash_no_name_is_pinned_twice_over_and_no_index_is_named() -> None:
    assert set(LOCKS) == {
        "requirements.lock",
        "requirements-dev.lock",
        "requirements-lowest.lock",
    }
    for name, text in LOCKS.items():
        pins = list(PIN.finditer(text))
        assert "".join(pin[0] for pin in pins) == text, f"{name} holds more than pins"
        assert all(re.search(r"--hash=sha256:[0-9a-f]{64}", pin[0]) for pin in pins)
        assert "://" not in text
    serving = {(p["name"], p["where"]) for p in PIN.finditer(LOCKS["requirements.lock"])}
    developing = {(p["name"], p["where"]) for p in PIN.finditer(LOCKS["requirements-dev.lock"])}
    assert not serving & developing


def test_what_one_lock_holds_is_left_out_of_the_other() -> None:
    hashed = " \\\n    --hash=sha256:0\n"
    first = f"a==1{hashed}b==2 ; x{hashed}"
    assert beyond(first, f"a==1{hashed}c==3{hashed}") == f"c==3{hashed}"
    assert beyond(first, f"b==2{hashed}") == f"b==2{hashed}", "of more platforms"
    with pytest.raises(ValueError, match="a is pinned to different versions"):
        beyond(first, f"a==2{hashed}")


def test_extras_are_for_users_and_groups_for_development() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert set(project["project"]["optional-dependencies"]) == {
        *("cluster", "deposit", "guide", "learn", "serve")
    }
    wanted = [one for group in project["dependency-groups"].values() for one in group]
    names = {re.split(r"[<>=]", one)[0].lower() for one in wanted if isinstance(one, str)}
    pinned = {pin["name"] for text in LOCKS.values() for pin in PIN.finditer(text)}
    assert names <= pinned


def test_actions_of_others_are_pinned_by_digest_with_their_version() -> None:
    files = [*ROOT.glob(".github/workflows/*.yml"), *ROOT.glob(".github/actions/*/*.yml")]
    used = [use for path in files for use in re.findall(r"uses: (\S.*)", path.read_text("utf-8"))]
    assert len(used) > 20
    for use in used:
        assert use.startswith("./") or re.fullmatch(r"\S+@[0-9a-f]{40} # v\d+\.\d+\.\d+", use)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("An answer without a Sun is a false Sun.", "false detection"),
        ("It stands for a sensor.", "represents"),
        ("The error is the the largest.", "repeated"),
    ],
)
def test_a_fault_of_prose_is_named(text: str, fault: str) -> None:
    assert fault in " ".join(prose.faults(text))
    assert prose.faults("The error is small.") == []


def test_prose_is_read_without_code_and_marks() -> None:
    page = "# Title\n\nOne *line*\nand [more](a.md) of `code`.\n\n```sh\nls\n```\n\n- item\n"
    said = [text for _, text in prose.markdown(page)]
    assert said == ["Title", "One line\nand more of ….", "item"]
    page = "<p>Errors of {{ name }} are <b>small</b>.</p>{% if a %}<style>p {}</style>{% endif %}"
    assert prose.template(page).splitlines()[0] == "Errors of … are small."


def test_lines_of_code_are_those_without_blanks_comments_and_docstrings() -> None:
    source = (
        '"""Module."""\n\n# why\ndef f(x):\n    """Say."""\n    return (\n        x  # it\n    )\n'
    )
    assert sizes.code_lines(source) == 4


def test_a_figure_above_its_limit_or_without_a_number_is_no_result() -> None:
    assert at_most(2.0, 2.0) == 2.0
    assert at_most(None, 9.0) == 9.0
    for value in (2.1, float("nan")):
        with pytest.raises(OverLimitError):
            at_most(2.0, value)


def test_a_ratio_is_of_the_best_times() -> None:
    now = [0.0]
    spent = iter([9.0, 9.0, 2.0, 6.0, 1.0, 5.0])

    def step() -> None:
        now[0] += next(spent)

    assert ratio(step, step, repeats=2, clock=lambda: now[0]) == 5.0


def test_a_fault_is_tried_with_the_tests_that_ran_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cosmic_ray")
    from tools import mutants

    caller = "from algorithms.k import inner\n\n\ndef asked(x):\n    return inner(\n        x)\n"
    kernel = "STEP = 2\n@compiled\ndef inner(x):\n    return x * STEP\n"
    text = {"api/a.py": caller, "algorithms/k.py": kernel}
    ran = {"api/a.py": {5: ["tests/api/test_a.py::test_a[1]", "tests/api/test_a.py::test_a[2]"]}}
    monkeypatch.setattr(mutants, "_sources", lambda: text)
    monkeypatch.setattr(mutants, "_ran", lambda file: ran.get(file, {}))
    expected = ran["api/a.py"][5]
    assert mutants.tests_of("api/a.py", [6]) == expected  # a line within the statement
    assert mutants.tests_of("algorithms/k.py", [4]) == expected  # a kernel: by who calls it
    assert mutants.tests_of("algorithms/k.py", [1]) == expected  # read at import: by who names it
    assert mutants.tests_of("api/a.py", [4]) == []
