"""A headless browser for the tests of the pages."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.web.opening import NO_GPU, READY_S, Open, Opened


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(
            executable_path=shutil.which("chromium-headless-shell"), args=[*NO_GPU, "--no-sandbox"]
        )
        yield started
        started.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[Open]:
    """Opens a file or an address in a window of its own, which keeps nothing of others."""
    contexts: list[Any] = []

    def start(page: Path | str, fragment: str = "", **options: Any) -> Opened:
        size = options.pop("size", (1200, 760))
        context = browser.new_context(viewport={"width": size[0], "height": size[1]}, **options)
        contexts.append(context)
        opened = Opened(context.new_page())
        opened.page.on("console", lambda message: opened.complaints.append(message.text))
        opened.page.on("pageerror", lambda error: opened.complaints.append(str(error)))
        opened.page.on("request", lambda request: opened.requests.append(request.url))
        started = time.monotonic()
        opened.page.goto((page if isinstance(page, str) else page.as_uri()) + fragment)
        opened.page.locator("main").wait_for(timeout=READY_S * 1000)
        opened.ready_s = time.monotonic() - started
        return opened

    yield start
    for context in contexts:
        context.close()
