"""Links from a page to its JSON and CSV are valid addresses, whatever the page is called."""

import pytest

from api.addresses import for_spreadsheets, twin


@pytest.mark.parametrize(
    ("path", "address"),
    [
        ("/", "/answer.json"),
        ("/algorithms/angular-loss + basic", "/algorithms/angular-loss%20+%20basic.json"),
        ("/architectures/PD/Single-Ap.", "/architectures/PD/Single-Ap..json"),
        ("/studies/Müller2026", "/studies/M%C3%BCller2026.json"),
    ],
)
def test_a_name_with_blanks_or_umlauts_is_escaped(path, address):
    assert twin(path, "", ".json") == address
    assert twin(path, "edition=all", ".json") == f"{address}?edition=all"


def test_the_query_stays_beside_what_spreadsheets_need():
    assert for_spreadsheets("/a b", "q=x") == "/a%20b.csv?q=x&safe=true"
