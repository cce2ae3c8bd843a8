"""The service as the processes of a server make it, each for itself."""

from __future__ import annotations

from fastapi import FastAPI

from api.server.app import create_app
from api.service.knowledge import Knowledge
from benchmark.processes import end_in_time


def application(*, loaded: bool = False) -> FastAPI:
    """Make the service; `loaded` loads what is known at once, not at start-up."""
    known = Knowledge()
    if loaded:
        known.load_all()
    return create_app(known)


def application_of_worker() -> FastAPI:
    """Make the service in one of several processes, which a signal ends within a second."""
    end_in_time()
    return application()
