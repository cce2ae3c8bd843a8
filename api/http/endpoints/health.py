"""/healthz: whether the service answers, and with how much."""

from __future__ import annotations

from fastapi import FastAPI, Request, Response
from pydantic_core import to_json

from api.http.knowledge import Knowledge
from api.http.negotiation import JSON, media_type
from api.http.parameters import Parameters
from api.http.shapes import Health

NO_PARAMETERS = Parameters()


def install(app: FastAPI, knowledge: Knowledge) -> None:
    """Serve /healthz in `app`. It is asked anew each time and never stored."""

    async def healthz(request: Request) -> Response:
        media_type(request.headers.get("accept"), (JSON,))
        NO_PARAMETERS.from_query(request.scope["query_string"])
        state = {
            "status": "ok",
            "version": app.version,
            "studies": len(knowledge.facts.studies),
            "datasets": len(knowledge.measurements.dataset_names),
            "scores": len(knowledge.measurements.scores),
        }
        return Response(to_json(state), media_type=JSON, headers={"Cache-Control": "no-store"})

    app.add_api_route(
        "/healthz",
        healthz,
        name="health",
        operation_id="health",
        summary="State of the service",
        response_model=Health,
    )
