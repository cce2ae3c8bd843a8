"""/v1/datasets/{name}/preview.png: what the observations of a data set look like."""

from __future__ import annotations

from collections.abc import Mapping

from api.http.endpoints.measured import dataset_name
from api.http.knowledge import Knowledge
from api.http.pictures import Picture


def pictures(knowledge: Knowledge) -> list[Picture]:
    """Return the pictures there are."""

    def draw(parts: Mapping[str, str]) -> bytes:
        from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - renders, so on demand

        return preview_png(knowledge.measurements.presets[parts["name"]])

    return [
        Picture(
            path="/v1/datasets/{name}/preview.png",
            name="dataset_preview",
            summary="A picture of a data set",
            description="Some of its nominal samples: frames from small to large incidence, "
            "profiles, currents over angle or time, or spikes by their time.",
            draw=draw,
            parts=(dataset_name(knowledge),),
            example={"name": "cmos-single-aperture"},
        )
    ]
