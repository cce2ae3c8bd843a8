"""Search on small texts with answers known by hand."""

from hypothesis import given, settings
from hypothesis import strategies as st

from api.service.index.index import Entry, Index

fuzz = settings(deadline=None, derandomize=True, max_examples=60)

ENTRIES = [
    Entry("study", "Liebe2001", "MEMS based Sun sensor", "Carl Liebe", "camera model; centroid"),
    Entry("study", "Chang2008", "High-accuracy centroiding", "Chang", "threshold; camera model"),
    Entry("claim", "C01", "A centroid beats a threshold", "", "camera"),
    Entry("word", "albedo", "Sunlight that the Earth reflects", "", "Poussée d'Archimède"),
]


def found(question, **options):
    return [hit.entry.id for hit in Index(ENTRIES).find(question, **options)]


def test_words_are_found_without_case_accents_or_endings():
    assert found("POUSSEE") == ["albedo"]
    assert found("centroiding") == ["Chang2008"]
    assert set(found("centroid")) == {"C01", "Liebe2001", "Chang2008"}


def test_a_slip_is_forgiven_and_an_exact_word_is_not_diluted_by_slips():
    assert found("treshold") == ["C01", "Chang2008"]
    assert found("albdeo") == ["albedo"]
    assert found("Leibe") == ["Liebe2001"]
    assert found("earht") == ["albedo"]
    assert found("mem") == ["Liebe2001"]  # a beginning, so no other three letters


def test_what_has_every_word_comes_first():
    assert found("camera threshold")[:2] == ["C01", "Chang2008"]
    assert found("camera threshold")[2] == "Liebe2001"


def test_a_name_of_parts_is_found_by_its_parts():
    assert found("2001") == ["Liebe2001"]


def test_rare_words_outweigh_common_ones():
    texts = [Entry("word", f"w{n}", "", "", "common") for n in range(20)]
    texts += [Entry("word", "both", "", "", "common rare"), Entry("word", "one", "", "", "rare x")]
    hits = {hit.entry.id: hit.score for hit in Index(texts).find("common rare")}
    assert hits["both"] == max(hits.values())
    assert hits["one"] > hits["w0"]


def test_kinds_narrow_and_nothing_is_found_of_nothing():
    assert found("centroid", kinds=("claim",)) == ["C01"]
    for nothing in ("", "!!! --", "zzzzzzzz"):
        assert found(nothing) == []


@fuzz
@given(st.text(max_size=60))
def test_any_question_is_answered_with_falling_ranks(question):
    hits = Index(ENTRIES).find(question)
    assert len({(hit.entry.kind, hit.entry.id) for hit in hits}) == len(hits)
