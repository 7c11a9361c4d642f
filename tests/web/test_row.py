"""The row on the page of a further model: its blades bear the names of the tables, and the compass its words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.json_files import read_json
from tests.core.study.making_scenes import write_script
from tests.web.making_page import FAR_FINDING, NEAR_FINDING, write_result
from tests.web.opening import Open

pytest.importorskip("playwright.sync_api")
pytestmark = [pytest.mark.browser, pytest.mark.tool("chromium-headless-shell"), pytest.mark.slow]

BLADES = {NEAR_FINDING: "7", FAR_FINDING: "2"}
"""The near plate is blade 1 of the surface and 7 of the row; blade 2 of the row is not on this surface."""
COVERAGE = [{"blade": 1, "name": "7", "views_2": 0.75}, {"blade": 2, "name": "8", "views_2": 0.5}]


def with_row(folder: Path, **row: Any) -> Path:
    """The page of the small result with a row and the blades of its findings."""
    page = write_result(folder)
    document = read_json(page.parent / "viewer.json")
    document["row"] = {"status": "estimated", "coverage": COVERAGE, **row}
    for one in document["defects"]:
        one["blade"] = BLADES[one["id"]]
    write_script(page.parent / "data.js", document)
    return page


def test_a_blade_has_one_name_in_all_places(tmp_path: Path, open_page: Open) -> None:
    shown = open_page(with_row(tmp_path))
    page = shown.page
    assert page.locator(".coverage li").all_inner_texts() == ["25 % of blade 7", "50 % of blade 8"]
    page.locator(".row", has_text="dent").first.click()
    fact = page.locator(".detail dl > div", has_text="Blade").locator("dd")
    assert fact.inner_text().startswith("7")
    fact.get_by_role("button", name="show it alone").click()
    assert shown.place()["b"] == 1, "its number on this surface"
    page.get_by_role("button", name="Only blade 7 is shown: show all").click()
    assert shown.place()["b"] is None
    page.locator(f".visit[data-finding='{FAR_FINDING}']").click(force=True)
    assert fact.inner_text().startswith("2")
    assert fact.get_by_role("button").count() == 0, "blade 2 of this surface is another one"
    assert shown.complaints == []


TURNS = [(0, -1, 0), (1, 0, 0), (0.7, 0.7, 0), (-0.4, -0.9, 0)]
"""Which way is up on the screen."""


AXES = {"up": (0, -50, 5), "aside": (50, 0, 5), "slant": (40, -40, 5), "deep": (3, 2, 60)}
"""A point of the axis by where it lies, as the cameras see it."""


@pytest.mark.parametrize("point", AXES.values(), ids=list(AXES))
def test_the_words_of_the_compass_lie_in_its_dial(tmp_path: Path, open_page: Open, point: tuple[float, ...]) -> None:
    """Wherever the root is, and however the view is turned."""
    shown = open_page(with_row(tmp_path, axis=[point[1], -point[0], 1e-6], point=point, root="inside"))
    for up in TURNS:
        camera = [0, 0, -3, 0, 0, 4, *np.divide(up, np.linalg.norm(up)), 35]
        shown.page.evaluate("camera => { location.hash = `cam=${camera}` }", camera)
        shown.settle()
        assert shown.page.evaluate("window.bladeatlas.camera()") == pytest.approx(camera, abs=1e-3)
        boxes = shown.page.evaluate(
            "[...document.querySelectorAll('.lines .dial, .lines text.way')]"
            ".map(one => [one.textContent, one.getBBox()]).map(([text, at]) => [text, at.x, at.y, at.width, at.height])"
        )
        (_, left, top, width, _), *words = boxes
        assert sorted(", ".join(text for text, *_ in words).split(", ")) == ["root", "tip", "up"]
        middle = np.array([left, top]) + width / 2
        for text, x, y, wide, high in words:
            corners = np.array([[x, y], [x + wide, y], [x, y + high], [x + wide, y + high]])
            assert np.linalg.norm(corners - middle, axis=1).max() < width / 2, (text, up)
