"""A method has one name wherever a reader meets it."""

from registry.catalogue import catalogue
from tools.method_names import names, second_names, texts, wrong_display_names


def test_each_method_has_one_name_over_pages_docs_and_commands():
    assert list(second_names(texts(), names())) == []


def test_another_separator_is_a_second_name():
    shown = {
        "a": "bctm + pinhole\nBCTM > LSQ\n`bctm` → `pinhole`\n{{ r.extractor }} → {{ r.model }}"
    }
    assert [number for _, number, _ in second_names(shown, {"bctm"})] == [2, 3, 4]


def test_each_method_has_one_display_name_that_says_whether_it_is_ours():
    assert list(wrong_display_names(catalogue().implementations(None))) == []


def test_a_missing_a_shared_and_a_hidden_display_name_are_found():
    some = [one for one in catalogue().implementations("extractor") if one.name in {"bctm", "tm"}]
    (missing,) = wrong_display_names(some, {"tm": "Template matching (our variant)"})
    assert missing.startswith("bctm:")
    shared = {"bctm": "Same (our variant)", "tm": "Same (our variant)"}
    assert len(list(wrong_display_names(some, shared))) == 2
    (hidden,) = wrong_display_names(some, {"bctm": "BCTM", "tm": "Template (our variant)"})
    assert hidden.startswith("bctm:")
