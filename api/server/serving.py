"""The service as the processes of a server make it, each for itself."""

from __future__ import annotations

import os

from api.server.app import create_app
from api.server.connections import FewAtOnce
from api.server.prefix import ForwardedPrefix
from api.service.knowledge import Knowledge
from benchmark.processes import end_in_time, take_time_to_end, work_for

#: Seconds in which a worker that is to end still answers; Uvicorn would say a word after five.
_ANSWERS_S = 4.0


def application(*, loaded: bool = False) -> ForwardedPrefix:
    """Make the service; `loaded` loads what is known at once, not at start-up.

    It trusts the proxies that Uvicorn would (`FORWARDED_ALLOW_IPS`).
    """
    known = Knowledge()
    if loaded:
        known.load_all()
    trusted = os.environ.get("FORWARDED_ALLOW_IPS", "127.0.0.1,::1")
    bounded = FewAtOnce(create_app(known))
    made = ForwardedPrefix(bounded, trusted)  # type: ignore[arg-type]
    bounded.proxies = made.trusted_hosts  # type: ignore[assignment]
    return made


def application_of_worker() -> ForwardedPrefix:
    """Make the service in one of several processes, which a signal ends when it has answered.

    It ends with the process that started it, too, which may have had no time to end it.
    """
    work_for(os.getppid())
    take_time_to_end(_ANSWERS_S)
    end_in_time()
    return application()
