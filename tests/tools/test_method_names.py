"""A method has one name wherever a reader meets it."""

from tools.method_names import names, second_names, texts


def test_each_method_has_one_name_over_pages_docs_and_commands():
    assert list(second_names(texts(), names())) == []


def test_another_separator_is_a_second_name():
    shown = {
        "a": "bctm + pinhole\nBCTM > LSQ\n`bctm` → `pinhole`\n{{ r.extractor }} → {{ r.model }}"
    }
    assert [number for _, number, _ in second_names(shown, {"bctm"})] == [2, 3, 4]
