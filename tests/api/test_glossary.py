"""The glossary: every abbreviation of the survey and every term of ours, each once."""

from collections import Counter

import pytest

from api import glossary as module
from api.glossary import GlossaryError, glossary
from registry.studies import facts


def test_every_value_of_the_taxonomy_has_its_name_in_full():
    terms = {(one.kind, one.term): one for one in glossary()}
    taxonomy = facts().taxonomy
    for attribute in ("detector", "mask", "extractor", "model", "task", "error", "accuracy"):
        for value in taxonomy.values(attribute):
            assert terms[attribute, value].name == taxonomy.name(attribute, value)
            assert terms[attribute, value].meaning.endswith(".")
    assert terms["detector", "CMOS"].name == "Complementary metal-oxide semiconductor imager"


def test_a_word_of_a_kind_has_one_meaning():
    counted = Counter((one.kind, one.term) for one in glossary())
    assert {key for key, count in counted.items() if count > 1} == set()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("term,meaning\n", "expected columns"),
        ("term,name,meaning,see,avoid\nbound,,a limit,x.md,\n", "line 2"),
        (
            "term,name,meaning,see,avoid\na,a,b,x.md,\na,a,c,x.md,\n",
            "line 3: 'a' stands there twice",
        ),
    ],
)
def test_a_table_that_is_not_sound_is_refused_with_its_line(tmp_path, monkeypatch, text, message):
    (tmp_path / "glossary.csv").write_text(text)
    monkeypatch.setattr(module, "files", lambda _: tmp_path)
    with pytest.raises(GlossaryError, match=message):
        module.words.__wrapped__()


def test_a_value_means_what_the_table_says_unless_two_attributes_have_it():
    terms = {(one.kind, one.term): one.meaning for one in glossary()}
    table = {one.term: one.meaning for one in module.words()}
    assert terms["detector", "CMOS"] == table["CMOS"]
    assert "Slit" in table
    assert terms["mask", "Slit"] != terms["model", "Slit"]
