"""`python proxy.py PREFIX PORT [say]`: a reverse proxy that removes a prefix, and serves no more.

It prints its own port; `say` sends X-Forwarded-Prefix.
"""

import sys
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

PREFIX, PORT, *SAY = sys.argv[1:]


class Handler(BaseHTTPRequestHandler):
    """Passes a request on, and back what is answered."""

    def do_GET(self) -> None:
        """Answer as the service behind does, or 404 outside the prefix."""
        if not self.path.startswith(f"{PREFIX}/"):
            self.send_error(404)
            return
        sent = {name: value for name, value in self.headers.items() if name != "Connection"}
        sent |= {"X-Forwarded-Prefix": PREFIX} if SAY else {}
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        behind = HTTPConnection("127.0.0.1", int(PORT), timeout=300)
        behind.request(self.command, self.path.removeprefix(PREFIX), body or None, sent)
        answer = behind.getresponse()
        self.send_response(answer.status)
        for header in answer.getheaders():
            self.send_header(*header)
        self.end_headers()
        self.wfile.write(answer.read())
        behind.close()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


Handler.do_POST = Handler.do_GET  # type: ignore[attr-defined]
server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
sys.stdout.write(f"{server.server_address[1]}\n")
sys.stdout.flush()
server.serve_forever()
