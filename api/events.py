"""Streams of events (server-sent events of the HTML standard): many clients wait, few questions reach the database.

A stream holds no session of the database while it waits or sends: it asks for the events behind the last number that it
sent, in pages. All streams of a process share one question for the last numbers of their accounts.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections import Counter
from collections.abc import AsyncIterator, Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial

from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from api.problems import log
from core.errors import BladeAtlasError
from store.admission import LimitReached
from store.events import Events, EventView
from store.settings import DeploymentSettings

STREAM = "text/event-stream"
POLL_S = 0.5
"""How often the database is asked, however many streams there are."""
HEARTBEAT_S = 15.0
PAGE = 200
"""Events that a stream holds in memory."""
_LONGEST_S = 3600.0
"""A stream ends then, and its client goes on with a new one; so what a process keeps for it ends too."""
_BEGIN = b"retry: 2000\n\n"
"""A client whose stream was cut comes back after so many milliseconds."""
_HEARTBEAT = b": still there\n\n"
_END = b"event: end\ndata: {}\n\n"


@dataclass
class EventFeed:
    """What the streams of one process share: their number, and the question whether there is something new."""

    read_last: Callable[[Collection[str]], Mapping[str, int]]
    """Number of the last event of each account."""
    settings: DeploymentSettings
    heartbeat_s: float = HEARTBEAT_S
    _open: Counter[str] = field(default_factory=Counter)
    _look: asyncio.Task[Mapping[str, int]] | None = None
    _looked_at: float = float("-inf")

    def enter(self, owner: str) -> None:
        """Count a stream; `LimitReached` when there are as many as may be. `leave` follows."""
        for used, name, suffix in (
            (self._open.total(), "max_event_streams", ""),
            (self._open[owner], "max_event_streams_per_owner", "_of_owner"),
        ):
            allowed = getattr(self.settings, name)
            if used >= allowed:
                message = f"{used} streams of events are open already, and {name} is {allowed}"
                raise LimitReached(message, code=f"too_many_event_streams{suffix}", where=name)
        self._open[owner] += 1

    def leave(self, owner: str) -> None:
        """A stream is over."""
        self._open[owner] -= 1
        if not self._open[owner]:
            del self._open[owner]

    async def changed(self, owner: str, known: int, seconds: float) -> bool:
        """Wait until the account has an event behind `known`; False when there is none after so many seconds."""
        deadline = time.monotonic() + seconds
        while (await self._last()).get(owner, 0) <= known:
            left = deadline - time.monotonic()
            if left <= 0:
                return False
            await asyncio.sleep(min(POLL_S, left))
        return True

    async def _last(self) -> Mapping[str, int]:
        """The last numbers of all accounts that have a stream, at most `POLL_S` old."""
        look = self._look
        foreign = look is not None and look.get_loop() is not asyncio.get_running_loop()
        if look is None or foreign or (look.done() and time.monotonic() - self._looked_at >= POLL_S):
            self._looked_at = time.monotonic()
            look = self._look = asyncio.create_task(run_in_threadpool(self.read_last, tuple(self._open)))
        # One stream that ends must not take the answer from the others.
        return await asyncio.shield(look)


@dataclass(frozen=True)
class Reading:
    """What one stream reads."""

    events: Events
    feed: EventFeed
    owner: str
    inspection_id: str | None
    """Only events of this inspection, until it is over; None = of the whole account, for ever."""
    may_go_on: Callable[[], bool]
    """False once the caller may not read any more."""
    is_over: Callable[[], bool]
    """True when nothing follows; asked in a thread, before events are read."""

    async def stream(self, after: int) -> AsyncIterator[bytes]:
        """Events behind a number as they come, with heartbeats between."""
        yield _BEGIN
        until = time.monotonic() + _LONGEST_S
        known = seen = after
        while time.monotonic() < until and self.may_go_on():
            over = await run_in_threadpool(self.is_over)
            seen = max(seen, (await run_in_threadpool(self.feed.read_last, (self.owner,))).get(self.owner, 0))
            page = await run_in_threadpool(partial(self.events.after, self.owner, known, PAGE, self.inspection_id))
            for event in page:
                known = event.number
                yield event_bytes(event)
            if page:  # it may have ended with the last of these: ask again before waiting
                continue
            if over:
                yield _END
                return
            # What was read of the account may be of other inspections: only what is behind it is news.
            if not await self.feed.changed(self.owner, max(known, seen), self.feed.heartbeat_s):
                yield _HEARTBEAT


class EventStream(StreamingResponse):
    """The answer; its place among the streams is held before it is made, and given back at its end."""

    def __init__(self, reading: Reading, after: int) -> None:
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        super().__init__(reading.stream(after), headers=headers, media_type=STREAM)
        self._reading = reading

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send until it is over or the client is gone; a database that is away cuts it off, and the client goes on."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._reading.feed.leave(self._reading.owner)

    async def stream_response(self, send: Send) -> None:
        """The body, torn where the database does not answer."""
        try:
            await super().stream_response(send)
        except (BladeAtlasError, SQLAlchemyError) as error:
            log.warning("events_cut_off", error=type(error).__name__)


def event_bytes(event: EventView) -> bytes:
    """An event in the form of a stream; JSON has no line breaks."""
    data = {
        "number": event.number,
        "type": event.type,
        "at": event.at.isoformat().replace("+00:00", "Z"),
        "inspection": dict(event.inspection),
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return f"id: {event.number}\nevent: {event.type}\ndata: {text}\n\n".encode()
