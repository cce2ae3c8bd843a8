"""A reverse proxy for tests: serves what is behind a prefix, which it takes off, and nothing else.

`python proxy.py PREFIX UPSTREAM_PORT [say]` prints its port; `say` sends X-Forwarded-Prefix.
"""

import sys
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

PREFIX, UPSTREAM, *SAYS = sys.argv[1:]
HOP_BY_HOP = {"connection", "keep-alive", "transfer-encoding"}


class Handler(BaseHTTPRequestHandler):
    """Passes a request on, and back what is answered."""

    protocol_version = "HTTP/1.1"

    def pass_on(self) -> None:
        """Answer as the service behind does, or 404 outside the prefix."""
        if not self.path.startswith(f"{PREFIX}/"):
            self.send_error(404, "outside the prefix")
            return
        sent = {name: value for name, value in self.headers.items() if name != "Connection"}
        sent["X-Forwarded-For"] = self.client_address[0]
        sent |= {"X-Forwarded-Prefix": PREFIX} if SAYS else {}
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        behind = HTTPConnection("127.0.0.1", int(UPSTREAM), timeout=300)
        behind.request(self.command, self.path.removeprefix(PREFIX), body or None, sent)
        answer = behind.getresponse()
        content = answer.read()
        self.send_response(answer.status)
        for name, value in answer.getheaders():
            if name.lower() not in HOP_BY_HOP:
                self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)
        behind.close()

    do_GET = do_HEAD = do_POST = pass_on  # noqa: N815 - as http.server calls them

    def log_message(self, *_: object) -> None:
        """Say nothing."""


if __name__ == "__main__":
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    sys.stdout.write(f"{server.server_address[1]}\n")
    sys.stdout.flush()
    server.serve_forever()
