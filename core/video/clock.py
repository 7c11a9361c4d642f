"""When each frame is shown: stamps that are missing, double or start again are made to go on."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

FALLBACK_RATE = Fraction(25)
"""Frames per second where a file states none."""


@dataclass(frozen=True)
class _Open:
    """What was true before a stamp jumped back: whether another recording begins there, the next stamp tells."""

    offset: int
    stamp: int


class PresentationClock:
    """Gives every frame a time, strictly increasing, in units of the stream's time base.

    A stamp before the latest one is either a slip of the writer or the beginning of another recording that was
    appended. Where the next stamp goes on from the new one, all further ones are shifted, so that the new part follows
    the old one by the duration of a frame; where it goes on from the old one, only the slip is filled in.

    Attributes:
        repaired: number of frames whose stamp was missing or not after the one before.
        joined: numbers of the frames at which another recording begins, from 0.
    """

    def __init__(self, time_base: Fraction, rate: Fraction | None) -> None:
        self._frame = max(1, round(1 / ((rate or FALLBACK_RATE) * time_base)))
        """What a frame lasts when it does not say so itself."""
        self._offset = 0
        self._stamp: int | None = None
        """The latest stamp, as it stands in the file."""
        self._end = 0
        """Time of the latest frame plus its duration."""
        self._time: int | None = None
        self._open: _Open | None = None
        self._count = 0
        self.repaired = 0
        self.joined: list[int] = []

    def time(self, stamp: int | None, duration: int) -> int:
        """Time of the next frame, from its stamp (None = missing) and its duration (0 = unknown)."""
        if stamp is not None and self._stamp is not None:
            self._settle(stamp)
            if stamp < self._stamp:
                self._open = _Open(self._offset, self._stamp)
                self._offset = self._end - stamp
                self.joined.append(self._count)
        time = self._end if stamp is None else stamp + self._offset
        if stamp is None or (self._time is not None and time <= self._time):
            self.repaired += 1
            time = time if self._time is None else max(time, self._time + 1)
        self._stamp = self._stamp if stamp is None else stamp
        self._time, self._end = time, time + (duration or self._frame)
        self._count += 1
        return time

    def finish(self) -> None:
        """No frame follows: a stamp that jumped back at the very end was a slip."""
        self._settle(None)

    def _settle(self, stamp: int | None) -> None:
        """Decide about the last jump back, from the stamp that follows it (None = none)."""
        before, self._open = self._open, None
        if before is not None and (stamp is None or stamp > before.stamp):
            self._offset, self._stamp = before.offset, before.stamp
            self.joined.pop()
            self.repaired += 1
