"""A receiver of webhooks as a process of its own, that can be killed: writes down every message before it answers."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from standardwebhooks import Webhook as StockWebhook

from bench.soak.servers import free_port
from tests.api.conftest import wait_until

_PROCESS = Path(__file__).with_name("receiving_process.py")


@dataclass
class Receiver:
    """The process as a test sees it."""

    log: Path
    port: int = field(default_factory=free_port)
    _process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/hook"

    def start(self, **answers: str) -> None:
        """Begin to listen.

        Args:
            answers: by a text in the message, a status to answer with instead of 204, ``dies`` (kill -9 between
                the message and its answer), or ``drips`` (an answer that never ends).
        """
        words = (str(_PROCESS), str(self.port), str(self.log), json.dumps(answers))
        self._process = subprocess.Popen([sys.executable, *words])
        wait_until(self._listens)

    def stop(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def died(self) -> bool:
        assert self._process is not None
        return self._process.wait(10) == -signal.SIGKILL

    def messages(self) -> list[dict[str, Any]]:
        """Everything that came, in order: ``headers`` and ``body``."""
        return [json.loads(line) for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def verified(self, secret: str) -> list[tuple[str, dict[str, Any]]]:
        """Id and content of every message, the signature checked by a stock library."""
        stock = StockWebhook(secret)
        return [(one["headers"]["webhook-id"], stock.verify(one["body"], one["headers"])) for one in self.messages()]

    def _listens(self) -> bool:
        try:
            return httpx.get(self.url).status_code == 200
        except httpx.TransportError:
            return False


@contextmanager
def receiver(folder: Path) -> Iterator[Receiver]:
    """A receiver that was not started yet."""
    made = Receiver(folder / "messages.jsonl")
    try:
        yield made
    finally:
        made.stop()
