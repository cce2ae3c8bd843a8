"""Parts of the service on their own: negotiation, validators, cursors, parameters, CSV."""

import csv
import gzip
import io
import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.http.nearest import nearest
from api.http.negotiation import CSV, JSON, accepts_gzip, media_type
from api.http.pagination import CURSOR, LIMIT, page
from api.http.parameters import Parameter, Parameters
from api.http.problems import Problem
from api.http.representations import Representation, RepresentationCache, matches
from api.http.tables import to_csv
from api.http.values import Choice, Flag, PositiveNumber, Text

fuzz = settings(deadline=None, derandomize=True)

PARAMETERS = Parameters(
    [
        Parameter("task", Choice(lambda: ("Accuracy", "Cost", "FOV")), "", repeatable=True),
        Parameter("max_error_deg", PositiveNumber(180), ""),
        Parameter("grouped", Flag(), "", default=False),
        Parameter("q", Text(50), ""),
        LIMIT,
        CURSOR,
    ]
)


def answered(call, *arguments):
    """What a call returns, or the status of the problem it raises."""
    try:
        return call(*arguments)
    except Problem as problem:
        json.dumps(problem.document("/"))
        return problem.status


@pytest.mark.parametrize(
    ("accept", "chosen"),
    [
        (None, JSON),
        ("", JSON),
        ("*/*", JSON),
        ("text/csv", CSV),
        ("TEXT/CSV; header=present", CSV),
        ("application/*", JSON),
        ("text/*", CSV),
        ("application/json;q=0.5, text/csv", CSV),
        ("text/csv;q=0.5, */*;q=0.1", CSV),
        ("application/json;q=0, */*", CSV),
        ("text/html, application/xhtml+xml, */*;q=0.8", JSON),
        ("text/csv;q=0.8, application/json;q=0.8", JSON),
    ],
)
def test_the_best_liked_offered_media_type_is_chosen(accept, chosen):
    assert media_type(accept, (JSON, CSV)) == chosen


@pytest.mark.parametrize(
    "accept", ["text/html", "application/json;q=0", "*/*;q=0", "json", "text/csv;q=2"]
)
def test_nothing_acceptable_is_a_406(accept):
    with pytest.raises(Problem) as refused:
        media_type(accept, (JSON, CSV))
    assert refused.value.status == 406
    assert "text/csv" in refused.value.detail


@pytest.mark.parametrize(
    ("header", "taken"),
    [
        (None, False),
        ("", False),
        ("gzip", True),
        ("br, gzip;q=0.8", True),
        ("*", True),
        ("gzip;q=0", False),
        ("gzip;q=0, *", False),
        ("identity, gzip;q=0.5", False),
        ("deflate, br", False),
    ],
)
def test_gzip_is_taken_when_the_client_takes_it(header, taken):
    assert accepts_gzip(header) is taken


@fuzz
@given(st.text(max_size=60))
def test_any_accept_header_is_answered_or_refused(header):
    accepts_gzip(header)
    assert answered(media_type, header, (JSON, CSV)) in (JSON, CSV, 406)


@pytest.mark.parametrize(
    ("header", "same"),
    [
        ('"abc"', True),
        ('W/"abc"', True),
        ('"x", "abc"', True),
        ('"x","y" , W/"abc"', True),
        ("*", True),
        (" * ", True),
        ('"ab"', False),
        ('"x", "y"', False),
        ("abc", False),
        ('"a*c"', False),
        ("", False),
    ],
)
def test_if_none_match_is_a_list_compared_weakly(header, same):
    assert matches(header, '"abc"') is same


def test_gzip_carries_the_same_bytes_and_no_time():
    body = b'{"a": 1}' * 200
    one, two = (Representation(body, "application/json") for _ in range(2))
    assert gzip.decompress(one.compressed) == body
    assert one.compressed == two.compressed
    assert one.digest == two.digest


def test_the_cache_forgets_the_least_recently_used_within_its_bounds():
    cache = RepresentationCache(most=10, most_bytes=250)
    for name in "abc":
        cache.put(name, Representation(b"x" * 100, "text/plain"))
    assert cache.get("a") is None
    assert cache.get("b") is not None
    cache.put("d", Representation(b"x" * 100, "text/plain"))
    assert cache.get("b") is not None
    assert cache.get("c") is None
    assert cache.bytes == 200
    cache.put("huge", Representation(b"x" * 1000, "text/plain"))
    assert len(cache) == 1
    assert cache.bytes == 1000


def read(query: str):
    return PARAMETERS.from_query(query.encode())


def refusal(query: str) -> Problem:
    with pytest.raises(Problem) as refused:
        read(query)
    return refused.value


def test_repeated_values_are_a_set():
    assert read("task=FOV&task=Accuracy&task=FOV")["task"] == ("Accuracy", "FOV")
    assert read("")["task"] == ()
    assert read("")["limit"] == 200


@pytest.mark.parametrize(
    "query",
    [f"max_error_deg={bad}" for bad in ("nan", "NaN", "inf", "-inf", "1e400", "-1", "0", "", "1_0")]
    + [f"max_error_deg={bad}" for bad in ("%D9%A1", "0x1", "1,5", "181", "Infinity", "%2B1")]
    + [f"limit={bad}" for bad in ("0", "501", "-1", "1.5", "x", "9" * 30)]
    + ["grouped=yes", "q=", "q=" + "x" * 51, "max_error_deg=1&max_error_deg=2", "cursor="],
)
def test_a_value_that_is_not_valid_is_a_422(query):
    problem = refusal(query)
    assert problem.status == 422
    assert problem.errors[0].parameter == query.partition("=")[0]


def test_a_parameter_has_a_hundred_values_at_most():
    assert read("&".join(["task=FOV"] * 100))["task"] == ("FOV",)
    assert refusal("&".join(["task=FOV"] * 101)).status == 422
    PARAMETERS.from_body({"task": ["FOV"] * 100})
    with pytest.raises(Problem):
        PARAMETERS.from_body({"task": ["FOV"] * 101})


def test_refusals_name_the_nearest():
    assert refusal("taks=FOV").errors[0].nearest == "task"
    assert refusal("taks=FOV").status == 400
    assert refusal("task=accurcy").errors[0].nearest == "Accuracy"
    assert refusal("task=fov").errors[0].nearest == "FOV"
    assert refusal("limit=1&lmit=2&tsk=3").errors[1].nearest == "task"


@pytest.mark.parametrize("query", ["task", "&&", "task=%ff", "task=FOV&" * 600, "=", "\xff=1"])
def test_a_query_that_cannot_be_read_is_a_400(query):
    with pytest.raises(Problem) as refused:
        PARAMETERS.from_query(query.encode("latin-1"))
    assert refused.value.status == 400


@fuzz
@given(st.binary(max_size=40))
def test_any_query_is_read_or_refused(query):
    found = answered(PARAMETERS.from_query, query)
    assert found in (400, 422) or set(found) == {p.name for p in PARAMETERS.declared}


@fuzz
@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.sampled_from(["task", "limit", "q", "x"]), inner, max_size=3)
        ),
    )
)
def test_any_body_is_read_or_refused(body):
    found = answered(PARAMETERS.from_body, body)
    assert found in (400, 422) or set(found) == {p.name for p in PARAMETERS.declared}


@fuzz
@given(
    st.lists(st.sampled_from(["Accuracy", "Cost", "FOV"]), max_size=4),
    st.none() | st.floats(0, 180, exclude_min=True),
    st.booleans(),
    st.integers(1, 500),
)
def test_query_body_and_canonical_form_mean_the_same(task, error, grouped, limit):
    body = {"task": task, "grouped": grouped, "limit": limit}
    if error is not None:
        body["max_error_deg"] = error
    arguments = PARAMETERS.from_body(body)
    canonical = PARAMETERS.canonical(arguments)
    assert read(canonical) == arguments
    assert PARAMETERS.canonical(read(canonical)) == canonical


def test_integers_beyond_floats_are_refused():
    with pytest.raises(Problem):
        PARAMETERS.from_body({"max_error_deg": 10**5000})
    with pytest.raises(Problem):
        PARAMETERS.from_body({"limit": 10**5000})


@fuzz
@given(st.integers(0, 40), st.integers(1, 15))
def test_pages_walk_the_whole_list_once(n, limit):
    rows = list(range(n))
    seen, cursor = [], None
    for _ in range(n + 1):
        arguments = {**read("task=FOV"), "limit": limit, "cursor": cursor}
        found = page(rows, "/v1/x", PARAMETERS, arguments)
        assert found.total == n
        assert (found.next is None) == (found.link is None)
        seen += found.items
        cursor = found.next
        if cursor is None:
            break
    assert seen == rows


def test_a_cursor_belongs_to_its_list():
    rows = list(range(10))
    arguments = {**read("task=FOV"), "limit": 3}
    cursor = page(rows, "/v1/x", PARAMETERS, arguments).next
    for path, query in [("/v1/y", "task=FOV"), ("/v1/x", "task=Cost")]:
        with pytest.raises(Problem):
            page(rows, path, PARAMETERS, {**read(query), "cursor": cursor})
    for wrong in ("x", "W10", cursor + "=", cursor[:-1], "é", "[" * 150):
        with pytest.raises(Problem) as refused:
            page(rows, "/v1/x", PARAMETERS, {**arguments, "cursor": wrong})
        assert refused.value.status == 400
    assert list(page(rows, "/v1/x", PARAMETERS, {**arguments, "cursor": cursor}).items) == [3, 4, 5]


def test_csv_survives_its_own_delimiters():
    rows = [
        {"a": 'x, "y"\nz', "b": {"c": 1.5, "d": None}, "e": ["p", "q"], "f": True},
        {"a": "", "b": {"c": float("nan")}, "e": [], "f": False, "late": 3},
    ]
    read_back = list(csv.DictReader(io.StringIO(to_csv(["a"], rows).decode(), newline="")))
    assert read_back == [
        {"a": 'x, "y"\nz', "b_c": "1.5", "b_d": "", "e": "p; q", "f": "true", "late": ""},
        {"a": "", "b_c": "", "b_d": "", "e": "", "f": "false", "late": "3"},
    ]


def test_an_empty_table_has_its_header():
    assert to_csv(["a", "b"], []) == b"a,b\r\n"


@fuzz
@given(st.text(max_size=80), st.lists(st.text(min_size=1, max_size=20), max_size=5))
def test_the_nearest_is_one_of_the_valid(text, valid):
    found = nearest(text, valid)
    assert found is None or found in valid
    for word in valid:
        assert nearest(word, [word]) is not None or not word.strip()
