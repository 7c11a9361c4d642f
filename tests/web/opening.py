"""A page opened in a browser of its own, with what went wrong in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

READY_S = 10.0
NO_GPU = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


@dataclass
class Opened:
    """A page, and what went wrong in it."""

    page: Any
    ready_s: float = 0.0
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def place(self) -> dict[str, Any]:
        """The state that the page is in."""
        state: dict[str, Any] = self.page.evaluate("window.bladeatlas.place()")
        return state

    def settle(self) -> None:
        """Wait until the 3D view rests and its labels are placed."""
        self.page.wait_for_timeout(350)


Open = Callable[..., Opened]


def faults(page: Any) -> list[tuple[str, str, str]]:
    """What axe finds in a page as it stands: rule, first place, and how to mend it."""
    page.evaluate((resources.files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8"))
    found = page.evaluate("axe.run().then(({ violations }) => violations)")
    return [(one["id"], one["nodes"][0]["html"][:160], one["nodes"][0]["failureSummary"][:200]) for one in found]
