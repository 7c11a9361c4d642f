"""Bytes that somebody damaged, the same ones each time."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

from tests.core.making_videos import every_ms, make_video

_BITS = (
    b"\0",
    b"\r\n",
    b"--b",
    b"--b--",
    b'name="',
    b"..",
    b"/",
    b'"',
    b";",
    b"\xff\xfe",
    b"%00",
    b"Content-Disposition: ",
)


def damaged(data: bytes, chance: random.Random) -> bytes:
    """A copy with a few bytes changed, cut out, doubled or put in."""
    changed = bytearray(data)
    for _ in range(chance.randint(1, 6)):
        at, length = chance.randrange(len(changed) + 1), chance.randrange(1, 30)
        kind = chance.randrange(5)
        if kind == 0:
            changed[at : at + 1] = bytes([chance.randrange(256)])
        elif kind == 1:
            del changed[at : at + length]
        elif kind == 2:
            changed[at:at] = changed[at : at + length]
        elif kind == 3:
            changed[at:at] = chance.choice(_BITS)
        else:
            del changed[at:]
    return bytes(changed)


def damaged_videos(folder: Path, number: int) -> Iterator[bytes]:
    """So many copies of a video, made in `folder`, with damaged headers of the container or of the streams in it."""
    source = make_video(folder / "whole.mp4", every_ms(100, 6))
    whole = source.read_bytes()
    source.unlink()
    header = whole.index(b"moov")
    chance = random.Random(4)
    for count in range(number):
        start = (0, header)[count % 2]
        end = start + 1500
        yield whole[:start] + damaged(whole[start:end], chance) + whole[end:]
