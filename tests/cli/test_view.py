"""`bladeatlas view`: the page from a server of this machine alone, and nothing else of the result."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from cli.main import main
from cli.view import page_server, require_pages
from core.errors import BadInput
from core.viewer.policy import POLICY
from tests.core.making_results import RESULTS, opened


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    tmp_path = tmp_path_factory.mktemp("served")
    folder = opened("two_models", tmp_path / "result")
    (tmp_path / "secret.txt").write_text("of somebody else")
    (folder / "viewer" / "link.txt").symlink_to(tmp_path / "secret.txt")
    with page_server(folder) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        with httpx.Client(base_url=f"http://127.0.0.1:{server.server_port}") as client:
            yield client
        server.shutdown()
        thread.join()


def test_the_pages_and_their_files_are_served(served: httpx.Client) -> None:
    assert served.get("/").headers["location"] == "/viewer/index.html"
    kinds = {
        "/viewer/index.html": "text/html; charset=utf-8",
        "/viewer/data.js": "text/javascript; charset=utf-8",
        "/viewer/viewer.json": "application/json",
        "/viewer/surface.glb": "model/gltf-binary",
        "/viewer/frames/0000.jpg": "image/jpeg",
        "/models/1/viewer/data.js": "text/javascript; charset=utf-8",
        "/models/1/viewer/frames/0005.jpg": "image/jpeg",
    }
    for path, kind in kinds.items():
        answer = served.get(path)
        assert answer.status_code == 200, path
        assert answer.headers["content-type"] == kind
        assert answer.headers["content-security-policy"] == POLICY
        assert answer.headers["x-content-type-options"] == "nosniff"
    assert served.get("/viewer/viewer.json").json()["model"]["count"] == 2


@pytest.mark.parametrize(
    "path",
    [
        "/summary.json",
        "/mapping/defects.json",
        "/viewer/",
        "/viewer/frames",
        "/viewer/frames/",
        "/viewer/../summary.json",
        "/viewer/%2e%2e/summary.json",
        "/viewer/..%2fsummary.json",
        "/viewer/link.txt",
        "/models/x/viewer/index.html",
        "/viewer/none.js",
        "/viewer/a%00b",
    ],
)
def test_nothing_else_is_served(served: httpx.Client, path: str) -> None:
    with served.stream("GET", httpx.URL(str(served.base_url)).copy_with(raw_path=path.encode())) as answer:
        assert answer.status_code == 404


def test_a_name_of_somebody_else_is_not_served(served: httpx.Client) -> None:
    port = served.base_url.port
    assert served.get("/viewer/index.html", headers={"Host": f"localhost:{port}"}).status_code == 200
    for host in (f"evil.example:{port}", "evil.example", ""):
        assert served.get("/viewer/index.html", headers={"Host": host}).status_code == 421


def test_it_listens_on_this_machine_alone(tmp_path: Path) -> None:
    with page_server(tmp_path) as server:
        assert server.server_address[0] == "127.0.0.1"
        with pytest.raises(BadInput, match=str(server.server_port)):
            page_server(tmp_path, server.server_port)


def test_a_result_without_a_page_gets_one_and_says_what_it_lacks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "old"
    shutil.copytree(RESULTS / "two_models", folder, ignore=shutil.ignore_patterns("viewer"))
    require_pages(folder, [])
    assert (folder / "viewer/index.html").is_file()
    assert "--video" in capsys.readouterr().out
    before = (folder / "viewer/data.js").stat().st_mtime_ns
    require_pages(folder, [])
    assert (folder / "viewer/data.js").stat().st_mtime_ns == before, "a page that is there is left alone"


def test_what_is_no_result_is_said_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", "--no-browser", str(tmp_path)]) == 2
    assert "summary.json" in capsys.readouterr().err
