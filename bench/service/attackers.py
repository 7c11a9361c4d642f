"""What strangers with keys do to a server while others want to be served; a process of its own.

`python -m bench.service.attackers` reads one JSON line (`Attack`), says ``ready`` when its connections stand, goes on
until its stdin ends, and prints what it counted as JSON.
"""

from __future__ import annotations

import asyncio
import json
import re
import resource
import socket
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import av

SILENT, HALF_OPEN, POSTERS = 100, 1100, 60
"""Connections that ask and do not read, that never end their header, and posts of one video side by side."""
_WIDTH, _HEIGHT, _FRAMES = 6400, 6144, 2000
_RATE = 25
_ESTABLISHED = 1
"""Of the states of a connection in TCP_INFO."""
_LOOK_S, _PAUSE_S = 1.0, 0.5
_OTHER_DESCRIPTORS = 2048
_STATUS = re.compile(rb"HTTP/1\.1 (\d{3}) ")
_BOUNDARY = "posted-again-and-again"


@dataclass(frozen=True)
class Attack:
    """Whom, with what, and how fast."""

    port: int
    video: str
    """Path of a video that takes long to look into."""
    video_key: str
    upload_key: str
    """Of another account: forms count as uploads, and would be refused as such."""
    paths: Sequence[str]
    """What the silent readers ask for, in turn."""
    uploads: int
    """How many are tried."""
    uploads_per_s: float


@dataclass
class Tally:
    """What the attackers got."""

    silent_opened: int = 0
    half_open_opened: int = 0
    half_open_held: int = 0
    """At the last look."""
    silent_held: int = 0
    videos: Counter[str] = field(default_factory=Counter)
    """Answers by status; ``cut`` or the error where none came."""
    uploads: Counter[str] = field(default_factory=Counter)


def make_slow_video(path: Path) -> None:
    """Write a video of some 60 kB whose look takes as long as it may: large pictures, none of which may be shown.

    It begins without a keyframe, so the decoder works through every picture and each is left out.
    """
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=_RATE)
        stream.options = {"preset": "ultrafast", "bf": "0", "g": "1000", "threads": "2"}
        stream.width, stream.height, stream.pix_fmt = _WIDTH, _HEIGHT, "yuv420p"
        black = av.VideoFrame(_WIDTH, _HEIGHT, "yuv420p")
        for plane, value in zip(black.planes, (16, 128, 128), strict=True):
            plane.update(bytes([value]) * plane.buffer_size)
        coded = []
        for number in range(2):
            black.pts = number
            coded += stream.encode(black)
        coded += stream.encode()
        unchanged = bytes(coded[1])
        for number in range(_FRAMES):
            packet = av.Packet(unchanged)
            packet.stream, packet.time_base, packet.is_keyframe = stream, Fraction(1, _RATE), False
            packet.pts = packet.dts = number
            container.mux(packet)


async def _all(attack: Attack) -> Tally:
    tally, over = Tally(), asyncio.Event()
    ask = f"GET {{}} HTTP/1.1\r\nHost: 127.0.0.1:{attack.port}\r\nAuthorization: Bearer {attack.video_key}\r\n\r\n"
    silent = [ask.format(attack.paths[i % len(attack.paths)]).encode() for i in range(SILENT)]
    half = [b"GET /v1/inspections HTTP/1.1\r\nHost: 127"] * HALF_OPEN
    stand = asyncio.Semaphore(0)

    def note_silent(opened: int, held: int) -> None:
        tally.silent_opened += opened
        tally.silent_held = held

    def note_half(opened: int, held: int) -> None:
        tally.half_open_opened += opened
        tally.half_open_held = held

    form = _form(attack)
    async with asyncio.TaskGroup() as group:
        group.create_task(_hold(attack.port, silent, over, stand, note_silent))
        group.create_task(_hold(attack.port, half, over, stand, note_half))
        for _ in range(2):
            await stand.acquire()
        tasks = [group.create_task(_again(attack.port, form, over, tally.videos)) for _ in range(POSTERS)]
        tasks.append(group.create_task(_open_uploads(attack, over, tally.uploads)))
        print("ready", flush=True)
        await asyncio.to_thread(sys.stdin.read)
        over.set()
        for task in tasks:  # some wait for a look that may take a minute
            task.cancel()
    return tally


async def _hold(
    port: int,
    requests: Sequence[bytes],
    over: asyncio.Event,
    stand: asyncio.Semaphore,
    note: Callable[[int, int], None],
) -> None:
    """Keep a connection open for every request, none of which is read from; open again those that were closed."""
    held: dict[int, socket.socket] = {}
    while not over.is_set():
        opened = 0
        standing = {number for number, one in held.items() if _stands(one)}
        for number, request in enumerate(requests):
            if number not in standing:
                if number in held:
                    held.pop(number).close()
                with suppress(OSError):
                    held[number] = await _opened(port, request)
                    opened += 1
        note(opened, len(standing))
        stand.release()
        with suppress(TimeoutError):
            await asyncio.wait_for(over.wait(), _LOOK_S)
    for one in held.values():
        one.close()


def _stands(one: socket.socket) -> bool:
    return one.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 1)[0] == _ESTABLISHED


async def _opened(port: int, request: bytes) -> socket.socket:
    loop, one = asyncio.get_running_loop(), socket.socket()
    one.setblocking(False)
    one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    try:
        await loop.sock_connect(one, ("127.0.0.1", port))
        await loop.sock_sendall(one, request)
    except BaseException:
        one.close()
        raise
    return one


def _form(attack: Attack) -> bytes:
    video = Path(attack.video).read_bytes()
    head = f'--{_BOUNDARY}\r\nContent-Disposition: form-data; name="video"; filename="v.mp4"\r\n\r\n'
    body = head.encode() + video + f"\r\n--{_BOUNDARY}--\r\n".encode()
    kind = f"multipart/form-data; boundary={_BOUNDARY}"
    return _post(attack, attack.video_key, "/v1/inspections", f"Content-Type: {kind}", len(body)) + body


def _post(attack: Attack, key: str, path: str, more: str, length: int) -> bytes:
    lines = (
        f"POST {path} HTTP/1.1",
        f"Host: 127.0.0.1:{attack.port}",
        f"Authorization: Bearer {key}",
        "Connection: close",
        f"Content-Length: {length}",
        more,
    )
    return ("\r\n".join(lines) + "\r\n\r\n").encode()


async def _again(port: int, request: bytes, over: asyncio.Event, tally: Counter[str]) -> None:
    """Send the same request again and again, whatever is answered."""
    while not over.is_set():
        tally[await _status(port, request)] += 1
        await asyncio.sleep(_PAUSE_S)


async def _open_uploads(attack: Attack, over: asyncio.Event, tally: Counter[str]) -> None:
    """Begin uploads at an even pace, and send none of their bytes."""
    request = _post(attack, attack.upload_key, "/v1/uploads", "Tus-Resumable: 1.0.0\r\nUpload-Length: 1048576", 0)
    began = time.monotonic()

    async def one() -> None:
        tally[await _status(attack.port, request)] += 1

    async with asyncio.TaskGroup() as group:
        for number in range(attack.uploads):
            await asyncio.sleep(max(0.0, began + number / attack.uploads_per_s - time.monotonic()))
            if over.is_set():
                return
            group.create_task(one())


async def _status(port: int, request: bytes) -> str:
    writer = None
    try:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(request)
        found = _STATUS.match(await reader.readline())
        return found[1].decode() if found else "cut"
    except OSError as error:
        return type(error).__name__
    finally:
        if writer is not None:
            writer.close()


def main() -> None:
    """Attack until stdin ends."""
    attack = Attack(**json.loads(sys.stdin.readline()))
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    wanted = SILENT + HALF_OPEN + POSTERS + _OTHER_DESCRIPTORS
    resource.setrlimit(resource.RLIMIT_NOFILE, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    print(json.dumps(vars(asyncio.run(_all(attack)))), flush=True)


if __name__ == "__main__":
    main()
