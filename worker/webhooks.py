"""The sender of webhooks: takes one webhook after the other and sends what is due to it."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field

from core.errors import BadInput
from core.versions import program_version
from store.db import Database
from store.deliveries import Deliveries, Message, Outcome, Turn
from store.json_log import logger
from store.outbound import Outbound, Unreachable
from store.settings import DeploymentSettings
from store.webhooks import Webhooks, signed_headers

_SERVE_S = 20.0
"""Then another webhook gets its turn."""
_log = logger("bladeatlas.webhooks")


@dataclass(frozen=True)
class WebhookSender:
    """Sends until nothing is due; as many as there are may do so side by side, in one process or in several."""

    deliveries: Deliveries
    outbound: Outbound
    seconds: float = 15.0
    """A receiver must have answered within this, in seconds."""
    stopped: threading.Event = field(default_factory=threading.Event)
    """Set when no further message may be sent."""

    def round(self) -> None:
        """Send all that is due now."""
        while not self.stopped.is_set() and (turn := self.deliveries.begin_turn()) is not None:
            try:
                self._serve(turn)
            finally:
                self.deliveries.end_turn(turn)

    def _serve(self, turn: Turn) -> None:
        until = time.monotonic() + _SERVE_S
        while not self.stopped.is_set() and time.monotonic() < until:
            message = self.deliveries.next(turn)
            if message is None:
                return
            outcome = self._send(turn.url, message)
            if not outcome.delivered:
                said = {"status": outcome.status, "reason": outcome.error}
                _log.warning("not_delivered", webhook=turn.webhook_id, delivery=message.delivery_id, **said)
            if not self.deliveries.note(turn, message, outcome):
                return

    def _send(self, url: str, message: Message) -> Outcome:
        # The receiver holds it against its own clock, so it is this machine's time and no other.
        headers = self._headers(message, int(time.time()))
        try:
            with self.outbound.call("POST", url, headers, self.seconds, message.body) as answer:
                status = answer.status  # nothing of what else it says is read
        except (BadInput, Unreachable) as error:
            return Outcome(None, error.message)
        return Outcome(status, "" if 200 <= status < 300 else f"it answered {status}")

    def _headers(self, message: Message, timestamp: int) -> Mapping[str, str]:
        return {
            "Content-Type": "application/json",
            "User-Agent": f"bladeatlas/{program_version()}",
            **signed_headers(message.id, timestamp, message.body, message.secrets),
        }


def webhook_sender(settings: DeploymentSettings, database: Database) -> WebhookSender:
    """The sender of this deployment."""
    # A lease must outlive the slowest receiver, else another sender would begin while one still waits.
    turn_s = 2 * settings.webhook_seconds + settings.lease_s
    deliveries = Deliveries(Webhooks(database), turn_s, settings.webhook_hours * 3600)
    return WebhookSender(deliveries, Outbound(settings.allowed_networks()), settings.webhook_seconds)
