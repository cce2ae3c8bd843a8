"""Parts of the service on their own: negotiation, and the nearest word."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.service.problems import Problem
from api.web.negotiation import CSV, JSON, media_type

fuzz = settings(deadline=None, derandomize=True)


def answered(call, *arguments):
    """What a call returns, or the status of the problem it raises."""
    try:
        return call(*arguments)
    except Problem as problem:
        json.dumps(problem.document("/"))
        return problem.status_code


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
    assert refused.value.status_code == 406
    assert "text/csv" in refused.value.detail


@fuzz
@given(st.text(max_size=60))
def test_any_accept_header_is_answered_or_refused(header):
    assert answered(media_type, header, (JSON, CSV)) in (JSON, CSV, 406)
