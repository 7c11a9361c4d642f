"""What holds for every route: health, errors as problems, versions, options."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.exc import OperationalError

from api.app import create_app
from api.problems import MEDIA_TYPE, status_of
from core.confinement import possible_guard
from core.errors import BadInput, BladeAtlasError, DiskFull, NoReconstruction, ResourceError
from core.settings import PRESET_NAMES, make_settings, option_names
from store.uploads import UploadLocked
from tests.api.conftest import Backend, client_of


def test_health_and_readiness(client: TestClient) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    checks = {"database": "ok", "artifacts": "ok", "disk": "ok"}
    guard = possible_guard()
    assert client.get("/readyz").json() == {"status": "ready", "checks": checks, "children_network": guard}


def test_a_server_that_cannot_take_work_is_not_ready(backend: Backend) -> None:
    broken = backend.with_settings(reserve_bytes=1 << 60, broker_url="redis://127.0.0.1:1/0")
    answer = client_of(broken).get("/readyz")
    assert (answer.status_code, answer.json()["code"]) == (503, "not_ready")
    assert [error["pointer"] for error in answer.json()["errors"]] == ["/checks/disk", "/checks/broker"]
    assert answer.headers["Retry-After"]
    assert client_of(broken).get("/healthz").status_code == 200


def test_system_names_the_engines_queues_and_workers(backend: Backend, client: TestClient) -> None:
    backend.create("one")
    answer = client.get("/v1/system").json()
    assert answer["engines"]["pycolmap"] != "not installed"
    assert answer["inspections"] == {"queued": 1}
    assert answer["queues"] == {"cpu": {"runnable": 1, "leased": 0}}
    assert answer["workers"] == []


def test_metrics_count_the_database_and_the_requests(backend: Backend, client: TestClient) -> None:
    backend.finished("one")
    client.get(f"/v1/inspections/{backend.create('two')}")
    text = client.get("/metrics").text
    assert 'bladeatlas_inspections{state="succeeded"} 1.0' in text
    assert 'bladeatlas_inspections{state="queued"} 1.0' in text
    route = 'route="/v1/inspections/{inspection_id}",status="200"'
    assert f'bladeatlas_http_requests_total{{method="GET",{route}}} 1.0' in text


def test_options_are_all_there_with_their_words(client: TestClient) -> None:
    answer = client.get("/v1/options").json()
    options = answer["options"]
    assert [option["name"] for option in options] == list(option_names())
    assert all(option["meaning"] and option["range"] and option["source"] for option in options)
    schema = answer["json_schema"]["properties"]["options"]
    assert schema["additionalProperties"] is False
    assert set(schema["properties"]) == set(option_names())
    window = schema["properties"]["matching.window"]
    assert (window["type"], window["minimum"], window["default"], window["unit"]) == ("integer", 1, 5, "frames")


def test_presets_can_be_posted_back(client: TestClient) -> None:
    answer = client.get("/v1/presets").json()
    assert set(answer["presets"]) == set(PRESET_NAMES)
    for name, values in answer["presets"].items():
        assert type(make_settings(name)).model_validate(values) == make_settings(name)


def test_limits_are_told(backend: Backend) -> None:
    answer = client_of(backend.with_settings(max_upload_bytes=77)).get("/v1/limits").json()
    assert (answer["max_upload_bytes"], answer["max_active"]) == (77, 100)


def test_unknown_preset_is_a_problem(client: TestClient) -> None:
    answer = client.get("/v1/presets/fast", headers={"X-Request-Id": "mine-1"})
    assert answer.status_code == 422
    assert answer.headers["content-type"] == MEDIA_TYPE
    body = answer.json()
    assert (body["code"], body["instance"], body["retryable"]) == ("bad_input", "/v1/presets/fast", False)
    assert "unknown preset 'fast'" in body["detail"]
    assert body["request_id"] == answer.headers["X-Request-Id"] == "mine-1"


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [("GET", "/nowhere", 404), ("POST", "/healthz", 405), ("GET", "/v1/inspections/", 404)],
)
def test_http_errors_are_problems(client: TestClient, method: str, path: str, status: int) -> None:
    answer = client.request(method, path, headers={"X-Request-Id": "not\tusable"})
    assert answer.status_code == status
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert answer.json()["status"] == status
    assert len(answer.json()["request_id"]) == 32


def test_unexpected_errors_are_problems_without_the_cause(backend: Backend) -> None:
    app = create_app(backend.services)

    @app.get("/broken")
    def broken() -> None:
        raise RuntimeError("secret")

    @app.get("/away")
    def away() -> None:
        raise OperationalError("SELECT", {}, Exception("host secret does not answer"))

    @app.get("/typed")
    def typed(number: int) -> int:
        return number

    client = TestClient(app, "http://127.0.0.1", client=("127.0.0.1", 1), raise_server_exceptions=False)
    for path, status in (("/broken", 500), ("/away", 503)):
        answer = client.get(path)
        assert (answer.status_code, answer.headers["content-type"]) == (status, MEDIA_TYPE)
        assert "secret" not in answer.text
        assert answer.json()["retryable"] is (status == 503)
    answer = client.get("/typed?number=x")
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/query/number")


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (BadInput("x"), 422),
        (BadInput("x", code="conflict"), 409),
        (BadInput("x", code="bad_cursor"), 400),
        (UploadLocked("x"), 423),
        (NoReconstruction("x"), 409),
        (DiskFull("x"), 507),
        (ResourceError("x"), 503),
        (BladeAtlasError("x"), 500),
    ],
)
def test_status_of_errors(error: BladeAtlasError, status: int) -> None:
    assert status_of(error) == status


def test_no_vision_library_is_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(tmp_path / "data"))
    names = ["torch", "kornia", "pycolmap", "open3d", "cv2", "av", "numba", "scipy"]
    code = f"import sys, api.app; api.app.create_app(); print([n for n in {names} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert (tmp_path / "data" / "bladeatlas.db").is_file()
