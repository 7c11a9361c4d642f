"""The process behind `tests.receiver`; without other imports, so that it starts at once."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

_DIES = "dies"
_DRIPS = "drips"


def _listen(port: int, log: Path, answers: dict[str, str]) -> None:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._answer(200)

        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"])).decode()
            with log.open("a") as stream:
                stream.write(json.dumps({"headers": dict(self.headers.items()), "body": body}) + "\n")
                stream.flush()
                os.fsync(stream.fileno())
            answer = next((said for text, said in answers.items() if text in body), "204")
            if answer == _DIES:
                os.kill(os.getpid(), signal.SIGKILL)
            elif answer == _DRIPS:
                self._drip()
            else:
                self._answer(int(answer))

        def _answer(self, status: int) -> None:
            self.send_response(status)
            self.send_header("Content-Length", "0")
            self.end_headers()

        def _drip(self) -> None:
            self.wfile.write(b"HTTP/1.1 200 OK\r\nX: ")
            for _ in range(200):
                self.wfile.write(b"x")
                self.wfile.flush()
                time.sleep(0.1)

        def log_message(self, format: str, *args: Any) -> None:
            """Tests need no lines of it."""

    ThreadingHTTPServer(("127.0.0.1", port), Handler).serve_forever()


if __name__ == "__main__":
    _listen(int(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3]))
