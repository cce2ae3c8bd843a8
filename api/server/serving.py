"""The service as the processes of a server make it: each for itself, set up by the environment.

`SUNATLAS_WORKING` names the working directory, where pictures are kept that had to be drawn.
"""

from __future__ import annotations

import os
from pathlib import Path

from fastapi import FastAPI

from api.server.app import create_app
from api.service.knowledge import Knowledge
from benchmark.processes import end_in_time

WORKING = "SUNATLAS_WORKING"


def application(*, loaded: bool = False) -> FastAPI:
    """Make the service with what is known now.

    Parameters
    ----------
    loaded : whether to load everything at once; else at start-up
    """
    working = os.environ.get(WORKING)
    known = Knowledge(working=Path(working) if working else None)
    if loaded:
        known.load_all()
    return create_app(known)


def application_of_worker() -> FastAPI:
    """Make the service in one of several processes, which a signal ends within a second."""
    end_in_time()
    return application()
