"""Counts and times of requests, against requests that are counted here."""

from prometheus_client.parser import text_string_to_metric_families

from api.server.app import create_app


def numbers(client):
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["cache-control"] == "no-store"
    return {
        (sample.name, *sorted(sample.labels.items())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def count(found, route, status, method="GET"):
    labels = sorted({"route": route, "status": str(status), "method": method}.items())
    return found.get(("sunatlas_http_requests_total", *labels), 0.0)


def test_requests_are_counted_by_route_and_never_by_path(atlas):
    before = numbers(atlas)
    for key in ("Liebe2001", "Chang2008", "Nobody1900"):
        atlas.get(f"/v1/studies/{key}")
    atlas.request("HEAD", "/v1/studies/Liebe2001")
    for path in ("/no/such/path", "/another"):
        atlas.get(path)
    atlas.request("BREW", "/v1/taxonomy")
    after = numbers(atlas)
    route = "/v1/studies/{key}"
    for where, status, method, more in [
        (route, 200, "GET", 3),  # HEAD is answered as GET
        (route, 404, "GET", 1),
        ("unmatched", 404, "GET", 2),
    ]:
        assert count(after, where, status, method) - count(before, where, status, method) == more
    labels = {value for key in after for name, value in key[1:] if name == "route"}
    assert not [label for label in labels if "Liebe2001" in label or "such" in label]
    methods = {value for key in after for name, value in key[1:] if name == "method"}
    assert "BREW" not in methods
    timed = ("sunatlas_http_seconds_count", ("method", "GET"), ("route", route))
    assert after[timed] - before.get(timed, 0.0) == 4


def test_what_fails_counts_as_500(client_of):
    app = create_app()

    @app.get("/fails")
    async def fails() -> None:
        raise ArithmeticError

    client = client_of(app)
    before = numbers(client)
    assert client.get("/fails").status_code == 500
    assert count(numbers(client), "/fails", 500) - count(before, "/fails", 500) == 1
