"""The glossary: every abbreviation of the survey and every term of ours, each once."""

from collections import Counter

from api import glossary as module
from api.glossary import glossary
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


def test_a_value_means_what_the_table_says_unless_two_attributes_have_it():
    terms = {(one.kind, one.term): one.meaning for one in glossary()}
    table = {one.term: one.meaning for one in module.words()}
    assert terms["detector", "CMOS"] == table["CMOS"]
    assert "Slit" in table
    assert terms["mask", "Slit"] != terms["model", "Slit"]
