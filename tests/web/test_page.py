"""The inspector's page in a headless browser: what it shows, what it answers, and that it asks nobody else."""

from __future__ import annotations

import gzip
import json
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest

from core.query import Result
from core.viewer.deliver import bundle, study_bundle
from core.viewer.policy import POLICY
from tests.core.making_plates import CROP
from tests.web.making_page import FAR_FINDING, FRAMES, HOSTILE, NEAR_FINDING, NEAR_PLACE, write_refused, write_result
from tests.web.opening import READY_S, Open, Opened, faults

pytest.importorskip("playwright.sync_api")
pytestmark = [pytest.mark.browser, pytest.mark.tool("chromium-headless-shell"), pytest.mark.slow]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("result")
    write_result(root)
    return root


@pytest.fixture
def view(open_page: Open, folder: Path) -> Open:
    """Opens the page of the small result, or another one."""

    def start(fragment: str = "", page: Path | str | None = None, **options: Any) -> Opened:
        return open_page(page or folder / "viewer" / "index.html", fragment, **options)

    return start


def test_it_opens_from_a_folder_and_asks_nobody(view: Open) -> None:
    opened = view(size=(800, 540))
    opened.settle()
    assert opened.ready_s < READY_S
    assert opened.complaints == []
    assert opened.requests
    assert {url.split(":")[0] for url in opened.requests} <= {"file", "data"}
    assert opened.page.evaluate("window.bladeatlas.findings") == 2


class Served(SimpleHTTPRequestHandler):
    """Files under the policy of the product's own servers."""

    def end_headers(self) -> None:
        self.send_header("Content-Security-Policy", POLICY)
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: the tests look at the browser."""


def test_it_opens_from_a_server_under_its_policy(view: Open, folder: Path) -> None:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Served, directory=str(folder / "viewer"))) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        opened = view(f"#d={NEAR_FINDING}", page=f"http://127.0.0.1:{server.server_port}/index.html")
        faces_follow(opened, NEAR_FINDING)
        server.shutdown()
    assert opened.complaints == []
    assert {url.split("/")[2] for url in opened.requests if url.startswith("http")} == {
        f"127.0.0.1:{server.server_port}"
    }


def faces_follow(opened: Opened, finding: int) -> None:
    """All four faces show the finding as selected."""
    opened.settle()
    page, name = opened.page, f"D{finding}"
    assert opened.place()["d"] == finding
    assert page.locator(".rows [aria-current=true] b").inner_text() == name
    assert page.locator(".tag.chosen").inner_text() == name
    assert name in page.locator(".drawn g:has(.strong) .name").text_content()
    assert page.locator(".track.chosen .lane").text_content().startswith(name)
    assert f"frame {10 * opened.place()['f']}" in page.locator(".timeline .time").inner_text()


def test_one_selection_has_four_faces(view: Open) -> None:
    opened = view()
    page = opened.page
    page.locator(".row", has_text="dent").first.click()
    faces_follow(opened, NEAR_FINDING)
    page.locator(f".visit[data-finding='{FAR_FINDING}']").click(force=True)
    faces_follow(opened, FAR_FINDING)
    page.get_by_role("button", name="Whole").click()
    opened.settle()
    at = page.evaluate("at => window.bladeatlas.onCanvas(at)", list(NEAR_PLACE))
    assert not at["hidden"]
    page.locator(".stage canvas").click(position={"x": at["x"], "y": at["y"]}, force=True)
    faces_follow(opened, NEAR_FINDING)
    page.keyboard.press("Escape")
    assert opened.place()["d"] is None
    select_frame(page, 5)
    box = page.locator(".drawn rect.box").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    faces_follow(opened, FAR_FINDING)
    assert opened.place()["p"] == pytest.approx([0.9, -0.4, 6.0], abs=0.05)
    assert opened.complaints == []


def select_frame(page: Any, index: int) -> None:
    page.get_by_role("tab", name="Frames").click()
    page.locator(".rows li").nth(index).locator("button").click()
    page.get_by_role("tab", name="Findings").click()


def test_the_address_keeps_the_state(view: Open) -> None:
    opened = view(f"#d={FAR_FINDING}&f=9&layer=support")
    page = opened.page
    assert (opened.place()["d"], opened.place()["f"], opened.place()["layer"]) == (FAR_FINDING, 9, "support")
    assert page.get_by_role("button", name="Support").get_attribute("aria-pressed") == "true"
    page.locator(".row", has_text="dent").first.click()
    address = page.url
    assert f"d={NEAR_FINDING}" in address
    page.reload()
    page.locator("main").wait_for()
    assert opened.place()["d"] == NEAR_FINDING
    assert page.url == address
    page.go_back()
    page.locator(".row[aria-current=true]", has_text=f"D{FAR_FINDING}").wait_for()
    faces_follow(opened, FAR_FINDING)


def test_a_camera_in_the_address_is_stood_at(view: Open) -> None:
    camera = [0, 0, -3, 0, 0, 4, 0, -1, 0, 35]
    opened = view("#cam=" + ",".join(map(str, camera)))
    opened.settle()
    assert opened.page.evaluate("window.bladeatlas.camera()") == pytest.approx(camera, abs=1e-3)


def test_pixels_show_what_the_query_says(view: Open, folder: Path) -> None:
    opened, result = view(), Result(folder)
    random = np.random.default_rng(7)
    asked = [
        (int(random.choice([*FRAMES, 3])), *(random.random(2) * (CROP.source_width, CROP.source_height)))
        for _ in range(500)
    ]
    shown = opened.page.evaluate("asked => asked.map(([f, x, y]) => window.bladeatlas.pointAt(f, x, y))", asked)
    near, same = 0, 0
    for (frame, x, y), found in zip(asked, shown, strict=True):
        expected = result.point_at(10 * frame, x, y)
        same += found["reason"] == expected.reason
        if expected.point is not None and found["reason"] is None:
            near += bool(np.linalg.norm(np.subtract(found["point"], expected.point)) <= result._spacing)
    placed = sum(one["reason"] is None for one in shown)
    assert placed > 100
    assert same >= 0.98 * len(asked)
    assert near >= 0.98 * placed
    assert {one["reason"] for one in shown} >= {"frame_not_registered", "outside_roi"}


def test_a_point_is_seen_by_the_frames_of_the_query(view: Open, folder: Path) -> None:
    opened, result = view(), Result(folder)
    for place in (NEAR_PLACE, (-0.3, 0.0, 6.0), (0.9, -0.4, 6.0)):
        found = opened.page.evaluate("at => window.bladeatlas.visibleFrames(at)", list(place))
        expected = result.visible_frames(np.array(place))
        assert [one["frame"] for one in found] == [one.frame_index for one in expected]
        assert [one["quality"] for one in found] == pytest.approx([one.quality for one in expected], abs=0.01)


def test_the_surface_lies_on_the_picture(view: Open, folder: Path) -> None:
    opened, result = view(), Result(folder)
    width, height = CROP.source_width, CROP.source_height
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    xy = np.column_stack([columns.ravel() - CROP.x0, rows.ravel() - CROP.y0])
    for view_row, frame in enumerate(FRAMES):
        text = opened.page.evaluate("([f, w, h]) => window.bladeatlas.silhouette(f, w, h)", [frame, width, height])
        drawn = np.frombuffer(text.encode(), np.uint8).reshape(height, width) == ord("1")
        rays = result.views.rays(xy, result.views.R[view_row])
        centers = np.broadcast_to(result.views.centers[view_row], rays.shape)
        truth = result._surface.cast(centers, rays).hit.reshape(height, width)
        assert 0.2 < truth.mean() < 1.0
        assert (drawn & truth).sum() / (drawn | truth).sum() >= 0.98, frame


STATES: dict[str, tuple[str, tuple[str, ...]]] = {
    "findings": (f"#d={NEAR_FINDING}", ()),
    "frames": ("#tab=frames&f=3", ()),
    "detections": ("#tab=detections&n=5&layer=support", ("o",)),
    "reject": (f"#d={FAR_FINDING}", ("r",)),
    "keys": ("", ("?",)),
}


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(view: Open, scheme: str) -> None:
    for state, (fragment, keys) in STATES.items():
        opened = view(fragment, color_scheme=scheme)
        for key in keys:
            opened.page.keyboard.press(key)
        opened.settle()
        assert faults(opened.page) == [], (state, scheme)


DIALOGS = "slyw"
"""Keys of actions, one for each form in which they ask: a choice, a word, several choices, a place on the frame."""


def test_axe_finds_nothing_in_what_asks_for_a_word(view: Open) -> None:
    page = view(f"#d={NEAR_FINDING}&f=1").page
    for key in DIALOGS:
        page.keyboard.press(key)
        page.locator(".pending" if key == "w" else ".ask").first.wait_for()
        assert faults(page) == [], key
        page.keyboard.press("Escape")
        page.locator(".pending, .ask").wait_for(state="detached")
    page.keyboard.press("d")
    page.keyboard.press("Enter")
    page.locator(".ask").wait_for()
    assert faults(page) == []


def test_a_finding_is_drawn_with_the_mouse(view: Open) -> None:
    opened = view("#f=1")
    page = opened.page
    box = page.locator(".drawn rect.box").first.bounding_box()  # of a detection of the near finding
    page.get_by_role("button", name="Add a finding").click()
    page.mouse.move(box["x"], box["y"])
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3)
    drawn = page.locator(".drawn rect.pending").bounding_box()
    assert (drawn["width"], drawn["height"]) == pytest.approx((box["width"] / 2, box["height"] / 3), abs=3)
    page.mouse.move(box["x"] + box["width"], box["y"] + box["height"])
    page.mouse.up()
    page.locator(".ask input").fill("crack")
    page.get_by_role("button", name="Keep").click()
    page.locator(".rows [aria-current=true] b", has_text="H1").wait_for()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save review.json").click()
    (record,) = json.loads(Path(saved.value.path()).read_text(encoding="utf-8"))["records"]
    document = json.loads((Path(page.url.removeprefix("file://").split("#")[0]).parent / "viewer.json").read_text())
    own = next(one for one in document["detections"] if one["frame"] == 1)
    size = (CROP.source_width, CROP.source_height) * 2
    assert (record["action"], record["value"]["frame"], record["value"]["label"]) == ("add", 1, "crack")
    assert record["value"]["box"] == pytest.approx(np.divide(own["box"], size).tolist(), abs=0.01)
    assert record["value"]["point"] == pytest.approx(NEAR_PLACE, abs=0.05)
    assert opened.place()["n"] is None, "the click that ends a drawing asks nothing"
    assert opened.complaints == []


def test_a_hostile_label_is_shown_and_does_not_run(view: Open) -> None:
    opened = view(f"#d={FAR_FINDING}&f=5")
    opened.settle()
    assert HOSTILE in opened.page.locator(".detail h2").inner_text()
    assert HOSTILE in opened.page.locator("h1").text_content()
    assert opened.page.locator("img[src=x]").count() == 0
    assert opened.page.title() != "ran"
    assert opened.complaints == []


def test_a_refused_result_opens_and_says_why(view: Open, tmp_path: Path) -> None:
    opened = view(page=write_refused(tmp_path))
    text = opened.page.locator("body").inner_text()
    assert "refused" in text
    assert "what bent_model means" in text
    assert "every model was refused: bent_model" in text
    assert "No surface is shown." in text
    assert opened.page.locator(".picture img").get_attribute("src") == "frames/0000.jpg"
    opened.page.get_by_role("tab", name="Detections").click()
    opened.page.locator(".row").first.click()
    assert "could not be registered" in opened.page.locator(".detail").inner_text()
    assert opened.complaints == []


def test_a_page_without_its_data_says_so(view: Open, folder: Path, tmp_path: Path) -> None:
    for name in ("index.html", "app.js", "style.css"):
        (tmp_path / name).write_bytes((folder / "viewer" / name).read_bytes())
    opened = view(page=tmp_path / "index.html")
    assert "data.js is not beside this page" in opened.page.locator("[role=alert]").inner_text()


def test_a_review_by_keyboard_outlives_a_reload_and_is_saved(view: Open) -> None:
    opened = view()
    page = opened.page
    press = page.keyboard.press
    press("ArrowRight")
    first = opened.place()["d"]
    press("a")
    press("ArrowRight")
    assert opened.place()["d"] not in (None, first)
    press("r")
    page.keyboard.press("ArrowDown")
    press("Enter")
    press("l")
    page.locator(".ask input").fill(HOSTILE)
    press("Enter")
    press("n")
    page.keyboard.type("a second look")
    press("Enter")
    press("z")
    page.reload()
    page.locator("main").wait_for()
    assert page.locator(".review.accepted").count() == 1
    assert page.locator(".review.rejected").count() == 1
    assert "Reviewed 2 of 2" in page.locator(".exports").inner_text()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save review.json").click()
    review = json.loads(Path(saved.value.path()).read_text(encoding="utf-8"))
    records = review["records"]
    assert [one["action"] for one in records] == ["accept", "reject", "relabel", "note", "undo"]
    assert [one["revision"] for one in records] == [1, 2, 3, 4, 5]
    assert (records[1]["reason"], records[2]["value"]) == ("wrong place", HOSTILE)
    assert records[4]["value"] == records[3]["id"], "an undo names what it takes back"
    assert page.title() != "ran"


def test_keys_can_be_switched_off(view: Open) -> None:
    opened = view(f"#d={NEAR_FINDING}")
    opened.page.keyboard.press("?")
    opened.page.get_by_label("single keys act").uncheck()
    opened.page.get_by_role("button", name="Close").click()
    opened.page.keyboard.press("2")
    assert opened.place()["layer"] == "picture"


def test_two_points_are_measured(view: Open) -> None:
    opened = view()
    page = opened.page
    opened.settle()
    page.keyboard.press("m")
    for place in ([-1.5, 0.2, 4.0], [-0.5, 0.2, 4.0]):
        at = page.evaluate("at => window.bladeatlas.onCanvas(at)", place)
        page.locator(".stage canvas").click(position={"x": at["x"], "y": at["y"]}, force=True)
    words = page.locator(".measured").inner_text().replace(";", "").split()
    assert float(words[1]) == pytest.approx(1.0, abs=0.03)
    assert float(words[words.index("surface") + 1]) == pytest.approx(1.0, abs=0.06)
    assert "unscaled" in page.locator(".measured").inner_text()


def test_a_narrow_window_shows_all_faces(view: Open) -> None:
    page = view(f"#d={NEAR_FINDING}", size=(400, 800)).page
    for name in ("Lists", "Surface", "Frame", "Timeline"):
        box = page.get_by_role("region", name=name, exact=True).bounding_box()
        assert box["width"] <= 400
        assert box["height"] > 60
    assert page.evaluate("document.documentElement.scrollWidth") <= 400


def test_the_bundle_is_small() -> None:
    assert set(bundle()) == set(study_bundle()) == {"app.js", "index.html", "style.css"}
    assert sum(len(gzip.compress(content, 9)) for content in bundle().values()) <= 260_000
