"""The study that asks people: one whole run of it in a browser, by a script in the place of a person."""

from __future__ import annotations

import csv
import io
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from core.study.build import ANSWERS, STUDY
from core.study.questions import task_id
from core.study.truth import Task
from tests.core.study.making_scenes import write_study
from tests.web.making_page import HOSTILE
from tests.web.opening import Open, faults

sync_api = pytest.importorskip("playwright.sync_api")
pytestmark = [pytest.mark.browser, pytest.mark.tool("chromium-headless-shell"), pytest.mark.slow]

PARTICIPANT = 2
"""Of the second group: the page on scene A, then the gallery on scene B."""
GIVEN_UP = task_id(Task.SPAN)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Without 3D, which costs most of the opening of a page: sixteen scenes are opened here."""
    with sync_api.sync_playwright() as playwright:
        path = shutil.which("chromium-headless-shell")
        started = playwright.chromium.launch(executable_path=path, args=["--disable-3d-apis", "--no-sandbox"])
        yield started
        started.close()


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_study(tmp_path_factory.mktemp("study"), contact=HOSTILE)


def choose(page: Any, group: str, option: str) -> None:
    page.get_by_role("group", name=group, exact=True).get_by_label(option, exact=True).check()


def press(page: Any, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


def begin(page: Any, number: int = PARTICIPANT) -> None:
    assert page.get_by_role("button", name="Begin").is_disabled(), "nobody begins without consent"
    page.get_by_label("I have read this").check()
    page.get_by_label("The number that you were given").fill(str(number))
    press(page, "Begin")
    choose(page, "How long have you worked with borescope inspections?", "never")
    choose(page, "How often do you use programs that show 3D models?", "every week")
    choose(page, "Do you see colours as most people do?", "yes")
    press(page, "Next")


def answer(page: Any, right: dict[str, list[str]], by_text: dict[str, str]) -> str:
    """Answer the question that is shown, rightly; gives the name of its task."""
    text = page.get_by_role("heading", level=1).inner_text()
    task = next(name for start, name in by_text.items() if text.startswith(start))
    page.get_by_role("button", name="Show the scene").click()
    said = right[task][0]
    if task == GIVEN_UP:
        press(page, "I cannot tell")
    elif said in ("root", "tip"):
        choose(page, "Your answer", said)
        press(page, "This is my answer")
    else:
        page.get_by_label("Your answer").fill(said.removeprefix("D"))
        press(page, "This is my answer")
    choose(page, "How sure are you of your answer?", "6")
    press(page, "Next")
    return task


def questionnaires(page: Any) -> None:
    for group in page.get_by_role("group").all():
        group.get_by_label("4", exact=True).check()
    press(page, "Next")
    for number, slider in enumerate(page.get_by_role("slider").all()):
        assert page.get_by_role("button", name="Next").is_disabled()
        slider.fill(str(10 * number))
    press(page, "Next")


def saved(page: Any, name: str) -> str:
    with page.expect_download() as told:
        press(page, name)
    return Path(told.value.path()).read_text(encoding="utf-8")


def test_a_whole_run(study: Path, open_page: Open) -> None:
    opened = open_page(study / STUDY / "index.html")
    page = opened.page
    key = json.loads((study / ANSWERS).read_text(encoding="utf-8"))
    script = (study / STUDY / "study.js").read_text(encoding="utf-8")
    data = json.loads(script.removeprefix("window.STUDY_DATA = ").removesuffix(";\n"))
    by_text = {one["text"].split("{")[0]: one["id"] for one in data["tasks"]}
    assert HOSTILE in page.locator("main").inner_text()
    begin(page)
    orders = []
    for scene, inner in (("A", "main.grid"), ("B", "section[aria-labelledby=e]")):
        press(page, "I am ready")
        done = []
        for position in range(len(Task)):
            frame = page.frame_locator("iframe")
            frame.locator(inner).wait_for(state="attached")
            assert not page.locator("iframe").is_visible(), "the scene is not seen before the clock runs"
            if (scene, position) == ("A", 3):
                page.reload()  # what was answered is kept, and the open question asked again
                page.get_by_role("button", name="Go on").click()
            done.append(answer(page, key["scenes"][scene], by_text))
        orders.append(done)
        questionnaires(page)
    for group in page.get_by_role("group").all():
        group.get_by_label("linked page").check()
    page.get_by_label("Why?").fill(HOSTILE)
    press(page, "Next")
    run = json.loads(saved(page, "Save as JSON"))
    rows = list(csv.DictReader(io.StringIO(saved(page, "Save as CSV"))))
    assert (run["study"], run["participant"], run["group"]) == (key["study"], PARTICIPANT, 1)
    assert [(block["condition"], block["scene"]) for block in run["blocks"]] == [("page", "A"), ("gallery", "B")]
    assert [block["order"] for block in run["blocks"]] == orders
    assert orders[0] != orders[1]
    for block in run["blocks"]:
        right = key["scenes"][block["scene"]]
        said = {one["task"]: one["answer"] for one in block["answers"]}
        assert said == {task: None if task == GIVEN_UP else answers[0] for task, answers in right.items()}
        assert all(one["seconds"] > 0 and one["confidence"] == 6 for one in block["answers"])
        assert block["sus"] == [4] * 10
        assert list(block["tlx"].values()) == [0, 10, 20, 30, 40, 50]
    assert run["preference"]["why"] == HOSTILE
    assert [row["task"] for row in rows] == [*orders[0], *orders[1]]
    assert {(row["sus"], row["tlx"]) for row in rows} == {("50", "25.00")}
    assert {url.split(":")[0] for url in opened.requests} <= {"file", "data", "blob"}
    assert [text for text in opened.complaints if "WebGL" not in text] == []
    assert page.title() != "ran"
    press(page, "They are saved: delete them here")
    page.reload()
    assert page.get_by_role("button", name="Begin").is_visible()


def test_who_stops_leaves_nothing(study: Path, open_page: Open) -> None:
    page = open_page(study / STUDY / "index.html").page
    begin(page)
    press(page, "Stop")
    press(page, "Yes, stop and delete")
    page.reload()
    assert page.get_by_role("button", name="Begin").is_visible()
    assert page.evaluate("localStorage.length") == 0


def test_what_was_done_to_a_scene_is_not_kept_for_the_next(study: Path, open_page: Open) -> None:
    page = open_page(study / STUDY / "index.html").page
    begin(page)
    press(page, "I am ready")
    for kept in (False, True):
        page.get_by_role("button", name="Show the scene").click()
        scene = page.frame_locator("iframe")
        scene.locator(".rows .row").first.click()
        assert scene.locator(".review.accepted").count() == 0
        scene.get_by_role("button", name="Accept", exact=True).click()
        scene.locator(".review.accepted").first.wait_for()
        if not kept:
            page.get_by_role("button", name="Open the scene anew").click()
            page.reload()
            page.get_by_role("button", name="Go on").click()
            press(page, "I am ready")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(study: Path, open_page: Open, scheme: str) -> None:
    page = open_page(study / STUDY / "index.html", color_scheme=scheme).page
    assert faults(page) == []
    begin(page)
    assert faults(page) == []
    press(page, "I am ready")
    assert faults(page) == []
    page.get_by_role("button", name="Show the scene").click()
    assert faults(page) == []
    press(page, "I cannot tell")
    assert faults(page) == []
