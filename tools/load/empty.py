"""The reference: an endpoint that does nothing, served as the service is."""

from __future__ import annotations

import uvicorn

from api.cli.commands.serve import address, listen
from api.server.connections import bounds
from tools.bench.service import empty_app


def main() -> None:
    """Serve on a free port of this machine, and print where."""
    with listen("127.0.0.1", 0) as listener:
        print(address(*listener.getsockname()), flush=True)
        config = uvicorn.Config(empty_app(), log_level="error", access_log=False, **bounds())
        uvicorn.Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
