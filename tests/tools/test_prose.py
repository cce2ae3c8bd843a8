"""The prose linter: which words are read, and what is a fault."""

import pytest

from tools.prose.texts import Block, html, markdown, sentences


def test_a_page_of_markdown_is_read_without_code_and_marks():
    page = "# Title\n\nOne *line*\nand [more](a.md) of `code`.\n\n```sh\nls\n```\n\n- item\n"
    assert [block.text for block in markdown("a.md", page)] == [
        "Title",
        "One line and more of `code`.",
        "item",
    ]


def test_a_template_is_read_without_its_instructions():
    page = "<p>Errors of {{ name }} are\n<b>small</b>.</p>{% if a %}<style>p {}</style>{% endif %}"
    assert [block.text for block in html("a.html", page)] == ["Errors of … are small."]


def test_sentences_end_at_stops_but_not_in_abbreviations():
    assert sentences("See vol. 3 of it. The rest follows.") == [
        "See vol. 3 of it.",
        "The rest follows.",
    ]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("An answer without a Sun is a false Sun.", "false detection"),
        ("It stands for a sensor.", "represents"),
        ("The sensor " + "very " * 40 + "small.", "words without a stop"),
        ("The error is the the largest.", "lexical"),
    ],
)
def test_a_fault_is_named(text, fault):
    pytest.importorskip("proselint")
    from tools.prose.__main__ import faults

    assert fault in " ".join(said for _, said in faults([Block("a", 1, text)]))
    assert not list(faults([Block("a", 1, "The error is small.")]))
