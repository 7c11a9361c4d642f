"""Published results in the browser: one of two models, whose pages lead to each other, and one that was refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.json_files import read_json
from tests.core.making_results import opened
from tests.core.study.making_scenes import write_script
from tests.web.opening import Open, Opened

pytest.importorskip("playwright.sync_api")
pytestmark = [pytest.mark.browser, pytest.mark.tool("chromium-headless-shell"), pytest.mark.slow]


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result of two models; of the second the row is known and how its blades go on from the first is not."""
    folder = opened("two_models", tmp_path_factory.mktemp("two") / "result")
    page = folder / "models" / "1" / "viewer"
    document = read_json(page / "viewer.json")
    document["row"] = {"status": "estimated", "coverage": [{"blade": 4, "name": "1-B4", "views_2": 0.75}]}
    for one in document["defects"]:
        one["blade"] = "1-B4"
    write_script(page / "data.js", document)
    return folder


def listed(shown: Opened) -> list[str]:
    return [row.inner_text() for row in shown.page.locator(".rows .row b").all()]


def test_models_lead_to_each_other_and_count_as_a_range(two: Path, open_page: Open) -> None:
    shown = open_page(two / "viewer" / "index.html", "#d=1")
    page = shown.page
    assert sorted(listed(shown)) == ["D0", "D1", "D2"]
    assert "3 findings here (3 to 4 in all models)" in page.locator("header").inner_text()
    assert "Model 0 of 2" in page.locator("header nav").inner_text()
    page.locator(".flags summary").click()
    flag = page.locator(".flags li", has_text="several models that could not be joined")
    assert "Compare findings of different models in the frames before you count them as two." in flag.inner_text()
    page.get_by_role("link", name="model 1").click()
    page.get_by_text("Model 1 of 2").wait_for()
    assert listed(shown) == ["D10"]
    assert shown.place()["d"] is None, "the other model's selection is not this one's"
    page.locator(".rows .row").first.click()
    page.locator(".detail h2", has_text="D10").wait_for()
    assert page.locator(".picture img").evaluate("image => image.complete && image.naturalWidth") == 160
    page.get_by_role("link", name="model 0").click()
    page.get_by_text("Model 0 of 2").wait_for()
    assert sorted(listed(shown)) == ["D0", "D1", "D2"]
    assert shown.complaints == []


def test_a_blade_of_a_model_that_stands_alone_has_its_name(two: Path, open_page: Open) -> None:
    shown = open_page(two / "models" / "1" / "viewer" / "index.html")
    page = shown.page
    assert "25 % of blade 1-B4" in page.locator(".coverage").inner_text()
    assert "blade 1-B4" in page.locator(".rows .row").inner_text()
    page.locator(".filters select").nth(2).select_option("1-B4")
    assert "1 of 1" in page.locator(".filters output").inner_text()
    page.locator(".rows .row").click()
    fact = page.locator(".detail dl > div", has_text="Blade").locator("dd")
    assert fact.inner_text().startswith("1-B4")
    assert fact.get_by_role("button").count() == 0, "no part of this surface is known to be that blade"
    assert shown.complaints == []


def test_a_published_refusal_says_why_and_what_to_do(tmp_path: Path, open_page: Open) -> None:
    folder = opened("refused", tmp_path / "refused")
    shown = open_page(folder / "viewer" / "index.html")
    text = shown.page.locator("body").inner_text()
    assert "No surface is shown." in text
    assert "no case has a model" in text
    assert listed(shown) == []
    shown.page.get_by_role("tab", name="Detections").click()
    assert "6 of 6" in shown.page.locator(".filters output").inner_text()
    assert shown.complaints == []
