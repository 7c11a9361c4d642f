"""The gallery, the page and the report, each driven in a browser as a practised person would.

Every answer is read off what is shown. Who looks at a page is given nothing by this code: what it cannot find on the
screen is None, and counts as not answered.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from bench.usability.klm import Hand
from core.study.truth import MIDDLE, Task

Answer = str | None
_SETTLE_MS = 400
_ANSWER_MS = 10_000


@dataclass
class Instrument:
    """A page that is open, and the hand at it."""

    LAYS_OUT_MS: ClassVar[int] = 500
    """How long a page that was just opened is left alone, because its script lays it out."""
    page: Any
    """Of Playwright."""
    boxed_frame: int = 0
    """Index of the frame whose box is asked about."""
    hand: Hand = field(default_factory=Hand)

    @property
    def tasks(self) -> Mapping[Task, Callable[[], Answer]]:
        """How each question is answered; those that it has no way to answer are left out."""
        raise NotImplementedError

    def click(self, locator: Any) -> None:
        """Point at something and press."""
        self.hand.point_and_press()
        locator.first.click(timeout=_ANSWER_MS)

    def choose(self, locator: Any, value: str) -> None:
        """Open a list of choices and take one."""
        self.hand.point_and_press()
        self.hand.point_and_press()
        locator.select_option(value, timeout=_ANSWER_MS)

    def read(self, locator: Any) -> str:
        """Look at something and take it in."""
        self.hand.look()
        return str(locator.first.inner_text()) if locator.count() else ""


class Gallery(Instrument):
    """Pictures with boxes, and a table of defects."""

    @property
    def tasks(self) -> Mapping[Task, Callable[[], Answer]]:
        """The table answers three; which finding a box is stands below its picture."""
        return {
            Task.COUNT: self._count,
            Task.LARGEST: self._largest,
            Task.BEST_FRAME: self._best_frame,
            Task.SAME: self._same,
        }

    def _rows(self) -> Any:
        return self.page.locator("section[aria-labelledby=e] tbody tr")

    def _count(self) -> Answer:
        self.hand.look()
        return str(self._rows().count())

    def _largest(self) -> Answer:
        return found(r"(D\d+)", self.read(self._rows()))

    def _best_frame(self) -> Answer:
        self.click(self._rows().first.locator("a"))
        self.page.wait_for_timeout(_SETTLE_MS)
        shown = self.page.locator("dialog p")
        text = self.read(shown) if shown.count() and shown.is_visible() else self.page.url
        return found(r"frame[ _]0*(\d+)", text)

    def _same(self) -> Answer:
        return found(r"(D\d+)", self.read(self.page.locator(f"figure[data-frame='{self.boxed_frame}'] .state")))


class Viewer(Instrument):
    """List, surface, frame and timeline of one selection."""

    @property
    def tasks(self) -> Mapping[Task, Callable[[], Answer]]:
        """All but those whose answer is nowhere on the page."""
        return {
            Task.COUNT: self._count,
            Task.LARGEST: self._largest,
            Task.BLADE: self._blade,
            Task.BEST_FRAME: self._best_frame,
            Task.SPAN: self._span,
            Task.ROOT_OR_TIP: self._root_or_tip,
            Task.NOT_SEEN: self._not_seen,
            Task.SAME: self._same,
        }

    def _list(self) -> Any:
        return self.page.locator(".rows .row")

    def _count(self) -> Answer:
        return found(r"of (\d+)", self.read(self.page.locator(".filters output")))

    def _largest(self) -> Answer:
        return found(r"(D\d+)", self.read(self._list()))

    def _blade(self) -> Answer:
        self.choose(self.page.locator(".filters select").first, "blade")
        self.page.wait_for_timeout(_SETTLE_MS)
        self.hand.look()
        blades = Counter(re.findall(r"blade (\d+)", " ".join(self._list().all_inner_texts())))
        return blades.most_common(1)[0][0] if blades else None

    def _choose_largest(self) -> None:
        self.click(self._list())
        self.page.wait_for_timeout(_SETTLE_MS)

    def _best_frame(self) -> Answer:
        self._choose_largest()
        return found(r"frame (\d+)", self.read(self.page.locator(".detail .chips button[aria-current=true]")))

    def _fact(self, name: str) -> str:
        return self.read(self.page.locator(".detail dl > div", has_text=name).locator("dd"))

    def _span(self) -> Answer:
        self._choose_largest()
        return found(r"^(\d+) ?%", self._fact("Span, chord"))

    def _root_or_tip(self) -> Answer:
        span = self._span()
        return None if span is None else "tip" if int(span) > 100 * MIDDLE else "root"

    def _not_seen(self) -> Answer:
        return least_seen(self.read(self.page.locator(".coverage")))

    def _same(self) -> Answer:
        box = self.page.locator(".drawn rect.box, .drawn polygon.box").first.bounding_box()
        if box is None:
            return None
        self.hand.point_and_press()
        self.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        self.page.wait_for_timeout(_SETTLE_MS)
        return found(r"(D\d+)", self.read(self.page.locator(".detail h2")))


class ReportPage(Instrument):
    """The report as a page: nothing to press, all to read."""

    LAYS_OUT_MS = 0

    @property
    def tasks(self) -> Mapping[Task, Callable[[], Answer]]:
        """Text answers all but which finding a box in another picture is."""
        return {
            Task.COUNT: lambda: found(r"Findings\s+(\d+)", self._text()),
            Task.LARGEST: lambda: found(r"(D\d+)", self._first()),
            Task.BLADE: self._blade,
            Task.BEST_FRAME: lambda: found(r"frame (\d+)", self._first()),
            Task.SPAN: self._span,
            Task.ROOT_OR_TIP: self._root_or_tip,
            Task.NOT_SEEN: lambda: least_seen(self._text()),
        }

    def _text(self) -> str:
        return self.read(self.page.locator("main"))

    def _first(self) -> str:
        return self.read(self.page.locator(".finding"))

    def _blade(self) -> Answer:
        rows = self.page.locator("h2:has-text('Summary') + table tr:has(td)")
        self.hand.look()
        counts = {found(r"blade (\S+)", text): int(text.split()[-1]) for text in rows.all_inner_texts()}
        known = {blade: count for blade, count in counts.items() if blade and blade.isdecimal()}
        return max(known, key=lambda blade: known[blade]) if known else None

    def _span(self) -> Answer:
        return found(r"(\d+)(?: ± \d+)? % of the span", self._first())

    def _root_or_tip(self) -> Answer:
        span = self._span()
        return None if span is None else "tip" if int(span) > 100 * MIDDLE else "root"


def found(pattern: str, text: str) -> Answer:
    """The first group of a pattern in a text; None where it is not there."""
    match = re.search(pattern, text)
    return match[1] if match else None


def least_seen(text: str) -> Answer:
    """The blade of which most is said not to be seen."""
    shares = {blade: int(share) for share, blade in re.findall(r"(\d+)\s?% of blade (\d+)", text)}
    return max(shares, key=lambda blade: shares[blade]) if shares else None
