"""What a decoder says of pictures that it hands on all the same."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import av.logging

_WARNINGS = ("EOI missing, emulating",)
"""Warnings that mean damage: this is all that is said of a JPEG picture whose data end early."""
_NUMBER = re.compile(r"\d+")
_HABIT_SHARE = 0.5
"""What is said of more of the pictures than this is the way in which their writer works, and no damage."""


@contextmanager
def listened() -> Iterator[list[tuple[int, str, str]]]:
    """Collect FFmpeg's messages of this thread: (level, source, text) each."""
    before, skipping = av.logging.get_level(), av.logging.get_skip_repeated()
    av.logging.set_level(av.logging.WARNING)
    av.logging.set_skip_repeated(False)
    try:
        with av.logging.Capture() as said:
            yield said
    finally:
        av.logging.set_skip_repeated(skipping)
        av.logging.set_level(before)


class Complaints:
    """Collects what was said of each packet, then tells which frames are damaged."""

    def __init__(self) -> None:
        self._of_packet: dict[int, frozenset[str]] = {}
        self._of_frame: dict[int, frozenset[str]] = {}
        self._frames = 0

    def heard(self, packet: int, said: Iterable[tuple[int, str, str]]) -> None:
        """Note the messages that came while a packet was decoded."""
        texts = frozenset(
            _NUMBER.sub("#", text.strip())
            for level, _, text in said
            if level <= av.logging.ERROR or text.startswith(_WARNINGS)
        )
        if texts:
            self._of_packet[packet] = texts

    def of(self, packet: int | None) -> bool:
        """Whether something was said of a packet."""
        return packet in self._of_packet

    def came(self, frame: int, packet: int | None) -> None:
        """Note that a frame came of a packet; None is the oldest one of which something was said."""
        self._frames += 1
        number = next(iter(self._of_packet), None) if packet is None else packet
        texts = self._of_packet.pop(number, None) if number is not None else None
        if texts:
            self._of_frame[frame] = texts

    def frames(self) -> tuple[int, ...]:
        """Frames of which something was said that is not said of most."""
        counts = Counter(text for texts in self._of_frame.values() for text in texts)
        habits = {text for text, count in counts.items() if count > _HABIT_SHARE * self._frames}
        return tuple(frame for frame, texts in self._of_frame.items() if texts - habits)
