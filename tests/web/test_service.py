"""The service in a browser: from an empty server to a reviewed finding, and two who review at once."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import uvicorn
from sqlalchemy import select

from api.app import create_app
from api.services import make_services
from bench.soak.servers import free_port
from core.states import InspectionState
from store.account_models import Scope
from store.factory import open_artifacts, open_database
from store.listing import Filter, list_inspections
from store.models import Artifact
from store.publishing import media_type
from store.reviews import Reviews
from store.settings import DeploymentSettings
from store.tables import defect_rows
from tests.api.conftest import ANNOTATIONS, VIDEO, Backend, Server, wait_until
from tests.core.inspection_report.making_reports import text_of
from tests.core.making_results import opened as committed
from tests.databases import put_new_tables
from tests.store.small_plan import GRAPH
from tests.web.making_page import FAR_FINDING, HOSTILE, NEAR_FINDING, write_result
from tests.web.opening import faults

pytest.importorskip("playwright.sync_api")
pytestmark = [pytest.mark.browser, pytest.mark.tool("chromium-headless-shell"), pytest.mark.slow]

READY_MS = 40_000


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Published files of a small result, by path."""
    root = tmp_path_factory.mktemp("result")
    write_result(root)
    shown = {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}
    return {**shown, "quality.json": b'{"verdict": "suspect", "flags": []}', "summary.json": b"{}"}


@dataclass
class Deployed:
    """A server on this machine, whose worker is the test."""

    backend: Backend
    address: str
    files: dict[str, bytes]

    def finish(self, inspection_id: str, files: dict[str, bytes] | None = None) -> None:
        """Do the work of an inspection, and publish a result as its own, the small one unless another is given."""
        self.backend.work(inspection_id)
        shown = files or self.files
        records = json.loads(shown["viewer/viewer.json"])["defects"]
        self.backend.publish(inspection_id, shown, defects=defect_rows(records))
        with self.backend.db.write() as session:
            for artifact in session.scalars(select(Artifact).where(Artifact.inspection_id == inspection_id)):
                artifact.media_type = media_type(artifact.path)

    def ids(self) -> list[str]:
        return [row.id for row in list_inspections(self.backend.db, Filter("default"), 10, None).rows]

    def records(self, inspection_id: str) -> list[Any]:
        return Reviews(self.backend.db).since(inspection_id)

    def viewer(self, inspection_id: str) -> str:
        return f"{self.address}/v1/inspections/{inspection_id}/viewer/index.html"


@pytest.fixture
def deployed(tmp_path: Path, files: dict[str, bytes]) -> Iterator[Deployed]:
    settings = DeploymentSettings(data_dir=tmp_path / "data", reserve_bytes=0, severities="fly,blend,scrap")
    put_new_tables(settings.folder("bladeatlas.db"))
    db = open_database(settings)
    backend = Backend(make_services(settings, db, open_artifacts(settings), wake=lambda _: None, graph=GRAPH))
    app = create_app(backend.services)
    app.state.bladeatlas.keys.fresh_s = 0.0  # keys are made behind the server's back
    port = free_port()
    server = Server(uvicorn.Config(app, host="127.0.0.1", port=port, log_level="error", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    wait_until(lambda: server.started)
    yield Deployed(backend, f"http://127.0.0.1:{port}", files)
    server.should_exit = True
    thread.join(10)
    db.close()


@dataclass
class Opened:
    """A page of a browser of its own, and what went wrong in it."""

    page: Any
    complaints: list[str]


@pytest.fixture
def look(browser: Any) -> Iterator[Callable[[str], Opened]]:
    contexts = []

    def start(address: str) -> Opened:
        context = browser.new_context(viewport={"width": 1200, "height": 800})
        context.set_default_timeout(READY_MS)
        contexts.append(context)
        opened = Opened(context.new_page(), [])
        opened.page.on("pageerror", lambda error: opened.complaints.append(str(error)))
        opened.page.on("console", lambda told: opened.complaints.append(told.text) if "Policy" in told.text else None)
        opened.page.goto(address)
        return opened

    yield start
    for context in contexts:
        context.close()


def test_from_an_empty_server_to_a_reviewed_finding(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    key = deployed.backend.key("default", Scope.READ, Scope.SUBMIT, Scope.REVIEW)["Authorization"].split()[1]
    opened = look(f"{deployed.address}/")
    page = opened.page
    assert faults(page) == []
    page.get_by_label("API key").fill("ba_wrong")
    page.get_by_role("button", name="Sign in").click()
    page.get_by_text("not valid").wait_for()
    page.get_by_label("API key").fill(key)
    page.get_by_role("button", name="Sign in").click()
    page.get_by_text("There is none yet.").wait_for()
    assert page.get_by_role("button", name="Send").is_disabled()
    page.locator("#files").set_input_files([str(VIDEO), str(ANNOTATIONS)])
    page.get_by_text("our own form: ").wait_for()
    assert "turbine.mp4 with turbine.json" in page.locator("#pairs").inner_text()
    assert deployed.ids() == [], "nothing is sent before it was shown"
    page.get_by_label("Label").fill(f"engine 4 {HOSTILE}")
    page.get_by_text("Engine and work").click()
    assert faults(page) == []
    page.get_by_label("engine serial").fill("V12345")
    page.get_by_role("button", name="Send").click()
    row = page.locator("#list > li")
    row.get_by_text("queued").wait_for()
    assert "engine serial: V12345" in row.inner_text()
    assert row.get_by_role("link", name="View").count() == 0
    (one,) = deployed.ids()
    deployed.finish(one)
    row.get_by_text("verdict suspect").wait_for()
    assert faults(page) == []
    row.get_by_role("link", name="View").click()
    page.locator("main.grid").wait_for()
    page.get_by_text("Kept by the service.").wait_for()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("a")
    wait_until(lambda: [kept.action for kept in deployed.records(one)] == ["accept"])
    assert deployed.records(one)[0].by == "default's key"
    page.reload()
    page.locator(".review.accepted").wait_for()
    assert opened.complaints == []
    assert page.title() != "ran"


def test_page_and_start_page_lead_to_the_report(
    deployed: Deployed, look: Callable[[str], Opened], tmp_path: Path
) -> None:
    root = committed("one_model", tmp_path / "result")
    files = {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}
    one = deployed.backend.create("one", label="one")
    deployed.finish(one, files)
    page = open_finding(look, deployed, one, 0).page
    page.keyboard.press("a")
    wait_until(lambda: len(deployed.records(one)) == 1)
    with page.expect_download() as told:  # this browser shows no PDF
        page.get_by_role("link", name="Report").click()
    assert "accepted" in text_of(Path(told.value.path()).read_bytes())
    page.goto(f"{deployed.address}/")
    with page.expect_download() as again:
        page.locator("#list > li").get_by_role("link", name="Report").click()
    assert Path(again.value.path()).read_bytes() == Path(told.value.path()).read_bytes()


def test_an_inspection_is_cancelled_tried_again_and_deleted(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    one = deployed.backend.create("waiting", label=f"first {HOSTILE}")
    page = look(f"{deployed.address}/").page
    page.get_by_role("button", name="Cancel first").click()
    wait_until(lambda: deployed.backend.services.inspections.get(one).state == InspectionState.CANCELLED)
    deployed.backend.finish(one)
    page.get_by_text("cancelled").wait_for()
    page.get_by_role("button", name="Retry first").click()
    page.get_by_text("queued").wait_for()
    page.get_by_role("button", name="Delete first").click()
    page.get_by_role("button", name="No").click()
    assert len(deployed.ids()) == 1
    page.get_by_role("button", name="Delete first").click()
    page.get_by_role("button", name="Yes").click()
    page.get_by_text("There is none yet.").wait_for()
    assert deployed.ids() == []
    assert page.title() != "ran"


def test_an_upload_that_is_cut_off_goes_on(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    page = look(f"{deployed.address}/").page
    cut: list[str] = []

    def once(route: Any) -> None:
        if route.request.method == "PATCH" and not cut:
            cut.append(route.request.url)
            route.abort()
        else:
            route.continue_()

    page.route("**/v1/uploads/*", once)
    page.locator("#files").set_input_files([str(VIDEO)])
    page.get_by_text("no annotations: the surface alone").wait_for()
    page.get_by_role("button", name="Send").click()
    page.locator("#list > li").get_by_text("queued").wait_for()
    assert len(cut) == 1
    assert len(deployed.ids()) == 1


def test_what_cannot_be_used_is_said(deployed: Deployed, look: Callable[[str], Opened], tmp_path: Path) -> None:
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(b"this is no video" * 100)
    page = look(f"{deployed.address}/").page
    page.locator("#files").set_input_files([str(broken)])
    page.get_by_text("the service looks into it").wait_for()
    page.get_by_role("button", name="Send").click()
    page.locator("#said:not(:empty)").wait_for()
    assert deployed.ids() == []


def reviewed(deployed: Deployed) -> str:
    one = deployed.backend.create("one", label="one")
    deployed.finish(one)
    return one


def open_finding(look: Callable[[str], Opened], deployed: Deployed, one: str, finding: int) -> Opened:
    opened = look(f"{deployed.viewer(one)}#d={finding}")
    opened.page.get_by_text("Kept by the service.").wait_for()
    return opened


def test_two_browsers_at_once_lose_nothing(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    one = reviewed(deployed)
    first = open_finding(look, deployed, one, NEAR_FINDING).page
    second = open_finding(look, deployed, one, NEAR_FINDING).page
    first.keyboard.press("a")
    wait_until(lambda: len(deployed.records(one)) == 1)
    second.keyboard.press("r")
    second.keyboard.press("Enter")
    second.get_by_text("Somebody else has spoken of this finding meanwhile (409).").wait_for()
    assert [kept.action for kept in deployed.records(one)] == ["accept"]
    assert "1 not sent yet" in second.locator(".exports").inner_text()
    second.reload()
    second.locator("main.grid").wait_for()  # who looks again has seen the others' word
    wait_until(lambda: len(deployed.records(one)) == 2)
    assert [kept.action for kept in deployed.records(one)] == ["accept", "reject"]
    third = open_finding(look, deployed, one, FAR_FINDING).page
    first.keyboard.press("n")
    first.keyboard.type(HOSTILE)
    first.keyboard.press("Enter")
    third.keyboard.press("a")  # of another finding: needs no question

    def all_there() -> bool:
        """The first reader is asked, unless its page has looked for what others say just before it sent."""
        if first.locator(".trouble").count():
            first.get_by_role("button", name="Send mine too").click()
        return sorted(kept.action for kept in deployed.records(one)) == ["accept", "accept", "note", "reject"]

    wait_until(all_there)
    assert first.title() != "ran"


def test_every_action_by_keyboard_reaches_the_service(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    one = reviewed(deployed)
    opened = open_finding(look, deployed, one, NEAR_FINDING)
    page, press = opened.page, opened.page.keyboard.press

    def last(action: str) -> Any:
        wait_until(lambda: bool(deployed.records(one)) and deployed.records(one)[-1].action == action)
        return deployed.records(one)[-1]

    press("s")
    press("ArrowDown")
    press("Enter")
    assert last("severity").value == "blend"
    press("t")
    page.keyboard.type("7")
    press("Enter")
    assert last("set_blade").value.endswith("7")
    press("y")
    press("Space")
    press("Enter")
    assert last("split").value == {"detections": [0]}
    press("g")
    press("Enter")
    assert last("merge").value["id"] == FAR_FINDING
    press("a")
    last("accept")
    press("b")
    press("w")
    press("ArrowRight")
    press("Enter")
    assert len(last("move").value["point"]) == 3
    press("d")
    press("ArrowLeft")
    press("Shift+ArrowRight")
    press("Enter")
    page.keyboard.type(f"crack {HOSTILE}")
    press("Enter")
    made = last("add")
    assert made.value["label"] == f"crack {HOSTILE}"
    assert made.value["point"] is not None
    page.locator(".rows [aria-current=true] b", has_text="H2").wait_for()
    press("r")
    press("Enter")
    assert last("reject").target.id == made.id
    press("z")
    assert last("undo").value != made.id
    folded = Reviews(deployed.backend.db).reviewed(one)
    assert [found.name for found in folded.findings] == [f"D{NEAR_FINDING}", f"D{FAR_FINDING}", "H1", "H2"]
    assert folded.findings[0].review.severity == "blend"
    assert folded.unattached == ()
    page.reload()
    page.locator(".rows b", has_text="H2").wait_for()
    assert (opened.complaints, page.title() == "ran") == ([], False)


def test_a_key_that_may_not_review_is_told_so(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    one = reviewed(deployed)
    key = deployed.backend.key("default", Scope.READ)["Authorization"].split()[1]
    opened = look(f"{deployed.address}/")
    opened.page.get_by_label("API key").fill(key)
    opened.page.get_by_role("button", name="Sign in").click()
    opened.page.locator("#list > li").wait_for()
    assert not opened.page.locator("#new").is_visible()
    opened.page.goto(f"{deployed.viewer(one)}#d={NEAR_FINDING}")
    opened.page.get_by_text("Your key may not review.").wait_for()
    opened.page.keyboard.press("a")
    opened.page.wait_for_timeout(300)
    assert deployed.records(one) == []


def test_what_could_not_be_sent_waits_for_the_service(deployed: Deployed, look: Callable[[str], Opened]) -> None:
    one = reviewed(deployed)
    page = open_finding(look, deployed, one, NEAR_FINDING).page
    page.context.set_offline(True)
    page.keyboard.press("a")
    page.get_by_text("The service does not answer.").wait_for()
    page.context.set_offline(False)
    page.reload()
    wait_until(lambda: [kept.action for kept in deployed.records(one)] == ["accept"])
