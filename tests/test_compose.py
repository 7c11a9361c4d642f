"""docker-compose.yml and docker-compose.s3.yml: what they say, and every service of them run as a process."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
import pytest

from bench.soak.client import SoakClient
from store.environment import SECRETS
from store.settings import PREFIX, DeploymentSettings
from tests.composition import OWN, ROOT, Composition, can_confine, composed, interpolated, merged, start_order
from tests.store.object_store import s3_server

PLAIN = ("docker-compose.yml",)
WITH_S3 = (*PLAIN, "docker-compose.s3.yml")
HARD = "p@ss:w/or d\"%41$HOME#1'"
"""What breaks addresses, shells, configuration files and percent-encoding."""
QUICK = {"BLADEATLAS_GRAPH": "bench.soak.toy:GRAPH", "BLADEATLAS_SWEEP_S": "0.5", "BLADEATLAS_RESERVE_BYTES": "0"}
"""All that the test adds to the environment of the compose files: stages without vision, and a shorter round."""
SERVICES = {"init", "api", "worker", "worker-gpu", "postgres", "redis"}


@pytest.fixture(params=[PLAIN, WITH_S3], ids=["plain", "s3"])
def services(request: pytest.FixtureRequest) -> dict[str, Any]:
    found: dict[str, Any] = merged(request.param, {})["services"]
    return found


def test_only_known_settings_are_set_and_secrets_come_from_files(services: dict[str, Any]) -> None:
    assert set(services) == SERVICES
    known = {f"{PREFIX}{name.upper()}" for name in DeploymentSettings.model_fields}
    files = {f"{PREFIX}{name.upper()}_FILE" for name in SECRETS}
    for name in OWN:
        service = services[name]
        assert set(service["environment"]) <= known | files
        used = {value for key, value in service["environment"].items() if key in files}
        assert used == {f"/run/secrets/{secret}" for secret in service["secrets"]}


def test_what_lasts_has_a_health_check_and_limits(services: dict[str, Any]) -> None:
    for name, service in services.items():
        assert {"memory", "pids"} <= set(service["deploy"]["resources"]["limits"]), name
        assert ("healthcheck" in service) == (name != "init"), name
        assert service["restart"] == ("no" if name == "init" else "unless-stopped"), name


def test_nothing_has_more_rights_than_it_needs(services: dict[str, Any]) -> None:
    for name, service in services.items():
        assert service["read_only"], name
        assert service["cap_drop"] == ["ALL"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        assert ("cap_add" in service) == (name == "postgres"), name
        assert "/tmp" in service["tmpfs"], name
        if name != "api":
            assert "ports" not in service, name
    assert all(one.startswith("127.0.0.1:") for one in services["api"]["ports"])


def test_every_secret_and_volume_that_is_used_is_declared() -> None:
    whole = merged(WITH_S3, {})
    used = {secret for service in whole["services"].values() for secret in service.get("secrets", ())}
    assert used == set(whole["secrets"])
    volumes = {one.partition(":")[0] for service in whole["services"].values() for one in service.get("volumes", ())}
    assert volumes == set(whole["volumes"])


def test_programs_start_after_what_they_need(services: dict[str, Any]) -> None:
    order = start_order(services)
    for name in ("api", "worker", "worker-gpu"):
        assert services[name]["depends_on"]["init"]["condition"] == "service_completed_successfully"
        assert order.index("postgres") < order.index("init") < order.index(name)
        assert order.index("redis") < order.index(name)


def test_the_gpu_worker_is_an_image_of_its_own(services: dict[str, Any]) -> None:
    gpu = services["worker-gpu"]
    assert gpu["build"]["args"] == {"TORCH_BUILD": "cuda", "PYCOLMAP": "pycolmap-cuda12"}
    assert gpu["image"] != services["worker"]["image"]
    assert gpu["profiles"] == ["gpu"]


def test_values_of_compose_files_are_read_as_compose_reads_them() -> None:
    variables = {"A": "one", "E": ""}
    assert interpolated({"k": ["${A:-x} ${B:-two} $$(c) ${E:-three}|${D}"]}, variables) == {
        "k": ["one two $(c) three|"]
    }


def test_secrets_are_made_once(tmp_path: Path) -> None:
    command = [ROOT / "scripts" / "secrets.sh", tmp_path / "secrets"]
    subprocess.run(command, check=True, capture_output=True)
    made = {path.name: path.read_text() for path in (tmp_path / "secrets").iterdir()}
    assert {Path(one["file"]).name for one in merged(PLAIN, {})["secrets"].values()} == set(made)
    assert all(len(text) == 32 for text in made.values())
    assert len(set(made.values())) == len(made)
    assert (tmp_path / "secrets").stat().st_mode & 0o077 == 0
    again = subprocess.run(command, check=True, capture_output=True, text=True)
    assert again.stdout == ""
    assert {path.name: path.read_text() for path in (tmp_path / "secrets").iterdir()} == made


@pytest.mark.deployment
@pytest.mark.service("postgresql")
@pytest.mark.service("redis")
@pytest.mark.parametrize(
    "with_s3",
    # The second file only adds to the first, so all that this starts is started by the other.
    [pytest.param(False, marks=pytest.mark.long), True],
    ids=["plain", "s3"],
)
def test_the_whole_system_starts_in_order_and_does_its_work(tmp_path: Path, with_s3: bool) -> None:
    if not with_s3:
        _run(tmp_path, PLAIN, {})
        return
    with s3_server() as address:
        _run(tmp_path, WITH_S3, {"S3_ENDPOINT": address, "S3_BUCKET": "blades"})


def _run(tmp_path: Path, files: tuple[str, ...], variables: Mapping[str, str]) -> None:
    with composed(tmp_path, files, {**variables, "WORKER_QUEUES": "cpu"}, QUICK) as system:
        secrets = {name: f"{HARD}{number}" for number, name in enumerate(system.whole["secrets"])}
        secrets |= {"s3_key": "key"} if "s3_key" in secrets else {}
        for name, value in secrets.items():
            (system.secrets / name).write_text(value + "\n", encoding="utf-8")
        for name in start_order(system.services):
            system.start(name)
        for name in ("api", "worker", "worker-gpu"):
            system.wait_healthy(name)
        key = system.said("init").strip()
        _use(system, key)
        _start_again(system)
        for name in ("worker", "worker-gpu"):
            system.processes[name].terminate()
            assert system.processes[name].wait(30) == 0
        assert not system.is_healthy("worker")
        system.stop()
        _said_nothing_secret(system, [value for name, value in secrets.items() if name != "s3_key"], key)


def _use(system: Composition, key: str) -> None:
    """An inspection through the API with the key that `init` printed, computed by the workers."""
    assert re.fullmatch(r"ba_[0-9a-f]{32}_[\w-]{43}", key)
    url = f"http://127.0.0.1:{system.ports['api']}"
    assert httpx.get(f"{url}/v1/inspections").status_code == 401
    client = SoakClient(url)
    client._http.headers["Authorization"] = f"Bearer {key}"
    made = client.submit("one", ROOT / "samples" / "turbine.mp4", ROOT / "samples" / "turbine.json", {})
    assert client.wait(made, 120)["state"] == "succeeded"
    fetched = system.root / "fetched"
    fetched.mkdir()
    assert client.download(made, fetched) == []
    assert any(fetched.iterdir())


def _start_again(system: Composition) -> None:
    """What `init` does at the next start of everything."""
    again = system.popen("init", system.services["init"]["command"], "init-again")
    assert again.wait(60) == 0
    assert system.said("init-again") == ""


def _said_nothing_secret(system: Composition, secrets: list[str], key: str) -> None:
    said = {path.name: path.read_text(errors="replace") for path in (system.root / "logs").iterdir()}
    assert "worker_started" in said["worker-err"]
    assert "connection authorized: user=bladeatlas" in said["postgres-err"]
    assert "no password" not in said["redis"]
    for secret in secrets:
        forms = {secret, quote(secret), quote(secret, safe=""), repr(secret)[1:-1], secret.partition("@")[2][:12]}
        assert {name for name, text in said.items() for form in forms if form in text} == set()
    assert {name for name, text in said.items() if key in text} == {"init"}


@pytest.mark.deployment
@pytest.mark.service("postgresql")
@pytest.mark.service("redis")
def test_a_wrong_password_is_refused_and_not_repeated(tmp_path: Path) -> None:
    with composed(tmp_path, PLAIN, {}, QUICK) as system:
        for name in system.whole["secrets"]:
            (system.secrets / name).write_text(HARD, encoding="utf-8")
        for name in ("postgres", "redis"):
            system.start(name)
        for name in ("postgres", "redis"):
            system.wait_healthy(name)
        (system.secrets / "redis_password").write_text(f"{HARD}-other", encoding="utf-8")
        assert not system.is_healthy("redis")
        system.processes["init"] = system.popen("init", ["bladeatlas", "init"], "init")
        assert system.processes["init"].wait(60) == 0
        (system.secrets / "postgres_password").write_text(f"{HARD}-other", encoding="utf-8")
        wrong = system.popen("init", ["bladeatlas", "keys", "list"], "wrong")
        try:
            wrong.wait(3)  # it waits a minute for a server that is just starting
        except subprocess.TimeoutExpired:
            wrong.kill()
            wrong.wait()
        assert system.said("wrong") == ""
        assert "password authentication failed" in system.said("postgres-err")
        assert not any(HARD in path.read_text(errors="replace") for path in (tmp_path / "logs").iterdir())


@pytest.mark.skipif(not can_confine(), reason="this machine lets no child have a file system of its own")
def test_a_program_of_ours_can_write_nothing_but_its_volumes(tmp_path: Path) -> None:
    system = Composition(tmp_path, PLAIN)
    for name in system.whole["secrets"]:
        (system.secrets / name).write_text("x", encoding="utf-8")
    outside = ROOT / "written-by-a-program-of-the-image"
    script = f"touch /data/in /artifacts/in /tmp/in && ! touch {outside.name} 2> /tmp/why"
    caps = "grep -q 'CapEff:.*0000000000000000' /proc/self/status && grep -q 'NoNewPrivs:.*1' /proc/self/status"
    assert system.popen("api", ["sh", "-c", f"{script} && {caps}"], "tried").wait(20) == 0, system.said("tried-err")
    assert not outside.exists()
    assert (system.folder("api", "/artifacts") / "in").exists()
    assert "Read-only" in (system.folder("api", "/tmp") / "why").read_text()
