"""The service's first routes, over ASGI."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from api.app import create_app
from api.problems import MEDIA_TYPE, status_of
from core.errors import BadInput, BladeAtlasError, DiskFull, NoReconstruction, ResourceError
from core.settings import PRESET_NAMES, make_settings, option_names


class Client:
    """Asks the application over ASGI, without a server."""

    def __init__(self, app: FastAPI) -> None:
        self.app = app

    def request(self, method: str, path: str) -> httpx.Response:
        async def ask() -> httpx.Response:
            # Errors become answers, as behind a real server.
            transport = httpx.ASGITransport(app=self.app, raise_app_exceptions=False)
            async with httpx.AsyncClient(transport=transport, base_url="http://test") as client:
                return await client.request(method, path)

        return asyncio.run(ask())

    def get(self, path: str) -> httpx.Response:
        return self.request("GET", path)


@pytest.fixture
def client() -> Client:
    return Client(create_app())


def test_health_and_readiness(client: Client) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    assert client.get("/readyz").json() == {"status": "ready", "checks": {"presets": "ok"}}


def test_system_names_the_engines(client: Client) -> None:
    answer = client.get("/v1/system").json()
    assert answer["engines"]["pycolmap"] != "not installed"
    assert answer["version"]


def test_options_are_all_there_with_their_words(client: Client) -> None:
    options = client.get("/v1/options").json()["options"]
    assert [option["name"] for option in options] == list(option_names())
    for option in options:
        assert option["meaning"]
        assert option["range"]
        assert option["source"]


def test_presets_can_be_posted_back(client: Client) -> None:
    answer = client.get("/v1/presets").json()
    assert set(answer["presets"]) == set(PRESET_NAMES)
    for name, values in answer["presets"].items():
        assert type(make_settings(name)).model_validate(values) == make_settings(name)
    assert set(answer["json_schema"]["properties"]) == set(answer["presets"]["default"])


def test_unknown_preset_is_a_problem(client: Client) -> None:
    answer = client.get("/v1/presets/fast")
    assert answer.status_code == 422
    assert answer.headers["content-type"] == MEDIA_TYPE
    body = answer.json()
    assert body["code"] == "bad_input"
    assert "unknown preset 'fast'" in body["detail"]
    assert body["instance"] == "/v1/presets/fast"


@pytest.mark.parametrize(("method", "path", "status"), [("GET", "/nowhere", 404), ("POST", "/healthz", 405)])
def test_http_errors_are_problems(client: Client, method: str, path: str, status: int) -> None:
    answer = client.request(method, path)
    assert answer.status_code == status
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert answer.json()["status"] == status


def test_unexpected_errors_are_problems_without_the_cause() -> None:
    app = create_app()

    @app.get("/broken")
    def broken() -> None:
        raise RuntimeError("secret")

    @app.get("/typed")
    def typed(number: int) -> int:
        return number

    client = Client(app)
    answer = client.get("/broken")
    assert (answer.status_code, answer.headers["content-type"]) == (500, MEDIA_TYPE)
    assert "secret" not in answer.text
    answer = client.get("/typed?number=x")
    assert (answer.status_code, answer.json()["where"]) == (422, "query.number")


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (BadInput("x"), 422),
        (NoReconstruction("x"), 409),
        (DiskFull("x"), 507),
        (ResourceError("x"), 503),
        (BladeAtlasError("x"), 500),
    ],
)
def test_status_of_errors(error: BladeAtlasError, status: int) -> None:
    assert status_of(error) == status


def test_openapi_has_examples_and_the_problem_schema(client: Client) -> None:
    document: dict[str, Any] = client.get("/openapi.json").json()
    assert "/v1/presets/{name}" in document["paths"]
    schemas = document["components"]["schemas"]
    assert schemas["Problem"]["example"]["code"] == "bad_input"
    assert schemas["Option"]["example"]["name"] in option_names()
    for path in document["paths"].values():
        assert "default" in path["get"]["responses"]


def test_no_vision_library_is_loaded() -> None:
    names = ["torch", "kornia", "pycolmap", "open3d", "cv2", "av", "numba"]
    code = f"import sys, api.app; api.app.create_app(); print([n for n in {names} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
