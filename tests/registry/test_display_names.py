"""A method has one display name, which says whether it is our variant of the survey's."""

from algorithms.display_names import DISPLAY_NAMES, VARIANT
from registry.catalogue import catalogue


def test_every_method_has_one_display_name_that_no_other_has():
    found = {part for one in catalogue().implementations(None) for part in one.name.split(" + ")}
    assert set(DISPLAY_NAMES) == found
    assert len(set(DISPLAY_NAMES.values())) == len(DISPLAY_NAMES)


def test_a_display_name_says_whether_the_method_is_our_variant():
    for one in catalogue().implementations(None):
        ours = one.summary.startswith("Our variant of ")
        if " + " not in one.name:
            assert DISPLAY_NAMES[one.name].endswith(VARIANT) is ours, one.name
