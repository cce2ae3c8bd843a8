"""`sunatlas claims` and /v1/claims say the same, and every word narrows the list."""

import json

from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.claims.ledger import ledger, tally


def run_claims(*arguments):
    answer = CliRunner().invoke(app, ["claims", *arguments])
    assert answer.exit_code == 0, answer.output
    return answer.stdout


def test_the_whole_ledger_is_listed():
    document = json.loads(run_claims("--format", "json"))
    assert document["total"] == 55
    assert document["tally"] == tally(ledger())
    for item in document["items"]:
        assert item["trials"] >= 5
        assert item["rules"]
        for rule in item["rules"]:
            assert rule["statistic"]
            assert rule["decides"]
            assert rule["trials"] <= item["trials"]


def test_verdicts_and_words_narrow(atlas):
    whole = json.loads(run_claims("--format", "json"))["items"]
    for item in whole:
        item["verdict"] = item["verdict"] or "not measured"
    for verdict in {item["verdict"] for item in whole}:
        found = json.loads(run_claims("--verdict", verdict, "--format", "json"))["items"]
        assert [item["id"] for item in found] == [
            item["id"] for item in whole if item["verdict"] == verdict
        ]
    found = json.loads(run_claims("--search", "albedo photodiodes", "--format", "json"))["items"]
    assert found == []
    found = json.loads(run_claims("--search", "ALBEDO dnn", "--format", "json"))["items"]
    assert [item["id"] for item in found] == ["C28"]
    assert atlas.get("/v1/claims", params={"q": "albedo dnn"}).json()["items"] == found
