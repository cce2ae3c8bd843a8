"""The two ways that `docs/architecture.md` lists are the ways that a frame and a query really take.

Every call is watched. Listed are this project's functions that are on the stack when a landmark of
the way is reached; what a sensor, an extractor or a model does within is its own matter.
"""

from __future__ import annotations

import asyncio
import re
import sys
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from types import CodeType, FrameType

import httpx
import pytest

from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from api.server.app import create_app
from benchmark import datasets
from benchmark.results.modules import FIRST_PARTY
from benchmark.running import condition_data
from benchmark.running.stages import Task
from benchmark.running.task import measure

ROOT = Path(__file__).parents[1]
MOST = 19  # four kept stages, each read or made
OWN_MATTER = ("benchmark/simulator/", "algorithms/extractors/", "algorithms/models/")


def listed(heading: str) -> list[str]:
    """Items ``path: function`` of the numbered list under a heading of the page."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = page.split(f"### {heading}\n")[1].split("\n#")[0]
    return re.findall(r"^\d+\. `([^`]+: [^`]+)`", section, re.MULTILINE)


def on_the_way(call: Callable[[], object], landmarks: Iterable[str]) -> list[str]:
    """Functions on the stack whenever a landmark is entered, in order of their first entry."""
    entered: dict[str, int] = {}
    found: set[str] = set()
    wanted = frozenset(landmarks)

    def watch(frame: FrameType, event: str, argument: object) -> None:
        if event != "call":
            return
        name = spelt(frame.f_code)
        if name is None:
            return
        entered.setdefault(name, len(entered))
        if name in wanted:
            above: FrameType | None = frame
            while above is not None:
                outer = spelt(above.f_code)
                if outer is not None and not outer.startswith(OWN_MATTER):
                    found.add(outer)
                above = above.f_back
            found.add(name)

    sys.setprofile(watch)
    try:
        call()
    finally:
        sys.setprofile(None)
    assert wanted <= set(entered), wanted - set(entered)
    return sorted(found, key=entered.__getitem__)


@cache
def spelt(code: CodeType) -> str | None:
    """``path: function`` of code of this project's own; None of any other."""
    path = Path(code.co_filename)
    if not any(path.is_relative_to(ROOT / floor) for floor in FIRST_PARTY):
        return None
    name = re.sub(r"\.?<locals>.*|\.?<\w+>", "", code.co_qualname)
    return f"{path.relative_to(ROOT).as_posix()}: {name}" if name else None


@pytest.mark.slow
def test_a_frame_passes_the_functions_listed_from_data_set_to_score() -> None:
    ways = listed("A frame, from data set to score")
    assert len(ways) <= MOST
    task = Task(
        datasets.get("cmos-single-aperture"), "nominal", BasicCentroid, (StandardProjection,)
    )
    condition_data.forget()
    landmarks = [
        "benchmark/datasets/preset.py: Preset.generate",
        "algorithms/extractors/frames/centroid.py: BasicCentroid.extract",
        "algorithms/calibration/calibrated.py: CalibratedModel.predict",
        "benchmark/metrics/score.py: score",
    ]
    assert on_the_way(lambda: measure(task), landmarks) == ways


@pytest.mark.slow
def test_a_query_passes_the_functions_listed_from_http_to_answer() -> None:
    ways = listed("A query, from HTTP to answer")
    assert len(ways) <= MOST
    app = create_app()

    async def asked(question: str) -> httpx.Response:
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://atlas.test") as client:
            return await client.get(f"/v1/recommendations?{question}")

    def ask() -> None:
        answer = asyncio.run(asked("task=Accuracy&min_fov_deg=61"))
        assert answer.status_code == 200
        assert answer.json()["architectures"]

    asyncio.run(asked("task=Cost"))  # facts and measurements are loaded by the first query
    landmarks = [
        "registry/answer.py: Answer.__init__",
        "registry/judging.py: Question.matching_places",
        "api/service/recommendations.py: document",
        "api/web/answers.py: Answer.representation",
        "api/web/answers.py: as_asked",
    ]
    assert on_the_way(ask, landmarks) == ways
