"""The row on the page of a further model: its blades bear the names of the tables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

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
