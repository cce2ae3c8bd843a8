"""The word that was probably meant: case aside, and none where nothing is like it."""

from __future__ import annotations

import pytest

from survey_data.nearest import nearest_name


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("CMSO", "CMOS"),
        ("cmos", "CMOS"),
        ("aps", "APS"),
        ("encodd", "Encoded"),
        ("zzz", None),
        ("", None),
        ("x" * 100_000, None),
    ],
)
def test_the_known_word_most_like_it_is_found_as_it_is_spelled(word, expected):
    assert nearest_name(word, ["APS", "CMOS", "Encoded", "Slit"]) == expected


def test_the_likeness_asked_for_decides():
    # 3 letters of 5 and 4 in common: 2 * 3 / 9 = 0.67
    assert nearest_name("slots", iter(["Slit"]), cutoff=0.66) == "Slit"
    assert nearest_name("slots", iter(["Slit"]), cutoff=0.67) is None


def test_of_words_equally_alike_the_first_by_alphabet_is_taken():
    assert nearest_name("Slat", ["Slot", "Slit", "Slut"]) == "Slit"
