"""The Python of docs/http.md runs as printed, against a server."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[3] / "docs" / "http.md"
SNIPPETS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def address(atlas, serve):
    with serve(atlas.app) as connection:
        yield f"http://{connection.host}:{connection.port}"


def run(snippet, address):
    names = {}
    exec(snippet.replace("http://127.0.0.1:8000", address), names)
    return names


def test_a_client_of_the_standard_library_prints_the_first_architecture(atlas, address, capsys):
    snippet = SNIPPETS[0]
    assert len(snippet.strip().splitlines()) <= 15
    assert set(re.findall(r"^(?:import|from) (\w+)", snippet, re.MULTILINE)) == {"json", "urllib"}
    asked = run(snippet, address)["requirements"]
    first = atlas.post("/v1/recommendations", json=asked).json()["architectures"][0]
    best = first["best"]["measured"]
    assert first["rank"] == 1
    assert capsys.readouterr().out == (
        f"{first['detector']} {first['mask']}: {best['extractor']} + {best['model']}\n"
        f"own error {best['own_error_deg']:.3g} deg\n"
    )


def test_a_table_is_one_line(atlas, address):
    best = run(SNIPPETS[1], address)["best"]
    items = atlas.get("/v1/leaderboard/architectures").json()["items"]
    assert list(best["rms_deg"].dropna()) == [
        i["rms_deg"] for i in items if i["rms_deg"] is not None
    ]
    assert list(best["mask"]) == [item["mask"] for item in items]


def test_a_long_list_is_walked_to_its_end(atlas, address):
    scores = run(SNIPPETS[2], address)["scores"]
    total = atlas.get("/v1/results?condition=nominal&limit=1").json()["total"]
    assert len(scores) == total > 500
    assert not scores.duplicated(["dataset", "extractor", "model"]).any()


def test_the_figures_of_measurements_have_the_numbers_of_their_documents(atlas, address, capsys):
    found = run(SNIPPETS[3], address)
    name, over, wins, losses, ratio = capsys.readouterr().out.split()
    cells = atlas.get("/v1/figures/robustness?hazard=saturation&hazard=glare").json()["items"]
    first = next(cell for cell in cells if cell["condition"] == "worst")
    assert (name, float(over)) == (first["name"], first["over_bound"])
    duels = atlas.get("/v1/figures/robustness?compare=mirror&compare=bctm").json()["duels"]
    outcomes = [duel["outcome"] for duel in duels]
    assert (int(wins), int(losses)) == (outcomes.count("win"), outcomes.count("loss"))
    assert float(ratio) == found["duel"]["ratio"]
    assert len(found["drawn"]["layout"]["yaxis"]["categoryarray"]) > len(found["best"]) > 5
