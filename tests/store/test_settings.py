"""Variables of the environment: those that nothing reads end the program, and the right name is told."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from kombu import Connection
from sqlalchemy import URL

from cli import exits
from cli.main import main
from core.errors import BadInput
from store.environment import SECRETS, deployment_settings
from store.settings import PREFIX
from tests.test_house import ROOT, texts

WRONG = f"{PREFIX}MAXACTIVE"


@pytest.mark.parametrize(
    ("variable", "words"),
    [
        (WRONG, f"did you mean '{PREFIX}MAX_ACTIVE'?"),
        (f"{PREFIX}DATABASE", f"did you mean '{PREFIX}DATABASE_URL'?"),
        ("bladeatlas_task_second", f"did you mean '{PREFIX}TASK_SECONDS'?"),
        (f"{PREFIX}X", "unknown variable"),
    ],
)
def test_a_variable_that_nothing_reads(monkeypatch: pytest.MonkeyPatch, variable: str, words: str) -> None:
    monkeypatch.setenv(variable, "1")
    with pytest.raises(BadInput, match=re.escape(words)) as caught:
        deployment_settings()
    assert (caught.value.code, caught.value.where) == ("unknown_setting", variable)


def test_values_that_do_not_fit_are_named_and_not_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (
        *(("MAX_ACTIVE", "secret"), ("ARTIFACTS_OPTIONS", "{secret")),
        *(("OUTBOUND_NETWORKS", "10.0.0.0/8, secret"), ("INPUT_HOSTS", "files.test, https://secret")),
    ):
        monkeypatch.setenv(PREFIX + name, value)
        with pytest.raises(BadInput, match=f"(?i){name}") as caught:
            deployment_settings()
        assert "secret" not in caught.value.message
        monkeypatch.delenv(PREFIX + name)


HARD = "p@ss:w/or d\"%41$HOME#1'?&"
"""A password with everything that means something in an address, a shell or a configuration file."""


def test_passwords_are_taken_as_they_are(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    values = {
        "DATABASE_URL": "postgresql://u@host/name",
        "DATABASE_PASSWORD": HARD,
        "BROKER_URL": "amqp://u@host:5672//",
        "BROKER_PASSWORD": HARD,
        "ARTIFACTS_KEY": "key",
        "ARTIFACTS_SECRET": HARD,
        "ARTIFACTS_ENDPOINT": "http://store:9000",
        "ARTIFACTS_OPTIONS": '{"client_kwargs": {"region_name": "r"}}',
    }
    for name, value in values.items():
        if name.lower() in SECRETS and name != "BROKER_URL":
            (tmp_path / name).write_text(f"{value}\n", encoding="utf-8")
            monkeypatch.setenv(f"{PREFIX}{name}_FILE", str(tmp_path / name))
        else:
            monkeypatch.setenv(PREFIX + name, value)
    found = deployment_settings()
    address = found.database()
    assert isinstance(address, URL)
    assert (address.username, address.password, address.host) == ("u", HARD, "host")
    broker = Connection(found.broker())
    assert (broker.userid, broker.password, broker.hostname, broker.virtual_host) == ("u", HARD, "host", "/")
    assert found.storage_options() == {
        "key": "key",
        "secret": HARD,
        "client_kwargs": {"region_name": "r", "endpoint_url": "http://store:9000"},
    }
    assert HARD not in repr(found)


@pytest.mark.parametrize(
    ("url", "made"),
    [
        ("redis://host:6379/0", "redis://:x%40y@host:6379/0"),
        ("redis://:old@host:6379/0", "redis://:x%40y@host:6379/0"),
        ("rediss://name@host", "rediss://name:x%40y@host"),
    ],
)
def test_a_password_replaces_that_of_the_address(monkeypatch: pytest.MonkeyPatch, url: str, made: str) -> None:
    monkeypatch.setenv(f"{PREFIX}BROKER_URL", url)
    assert deployment_settings().broker() == url
    monkeypatch.setenv(f"{PREFIX}BROKER_PASSWORD", "x@y")
    assert deployment_settings().broker() == made


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("DATABASE_URL", "postgresql://u:secr@et@host/name"),
        ("DATABASE_URL", "secret"),
        ("BROKER_URL", "redis://:secret/b@host"),
        ("BROKER_URL", "redis://:secret#b@host"),
        ("BROKER_URL", "redis://:b@secret@ho st"),
        ("BROKER_URL", "foo://secret"),
        ("BROKER_URL", "secret"),
        ("DATABASE_PASSWORD_FILE", "secret-file-that-is-not-there"),
        ("ARTIFACTS_OPTIONS_FILE", "no-json"),
    ],
)
def test_addresses_are_looked_at_before_anything_starts(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, variable: str, value: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "no-json").write_text("{secret", encoding="utf-8")
    monkeypatch.setenv(PREFIX + variable, value)
    with pytest.raises(BadInput, match=f"^{PREFIX}{variable}: ") as caught:
        deployment_settings()
    assert caught.value.code == "bad_setting"
    assert "secret" not in caught.value.message.replace("secret-file-that-is-not-there", "")


def test_a_secret_is_given_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x", encoding="utf-8")
    monkeypatch.setenv(f"{PREFIX}BROKER_PASSWORD_FILE", str(tmp_path / "file"))
    monkeypatch.setenv(f"{PREFIX}BROKER_PASSWORD", "y")
    with pytest.raises(BadInput, match="both set"):
        deployment_settings()
    monkeypatch.delenv(f"{PREFIX}BROKER_PASSWORD_FILE")
    monkeypatch.setenv(f"{PREFIX}MAX_ACTIVE_FILE", str(tmp_path / "file"))
    assert code_of_settings() == "unknown_setting"


def test_every_variable_of_the_repository_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Documents, compose file, benchmarks and tests name no variable that would end the program."""
    found = {name for _, text in texts() for name in re.findall(rf"\b{PREFIX}[A-Z][A-Z_]*[A-Z]\b", text)}
    for name in found - {WRONG, f"{PREFIX}DATABASE"}:
        monkeypatch.setenv(name, "1")
        assert code_of_settings() != "unknown_setting", name
        monkeypatch.delenv(name)
    assert len(found) > 15


def code_of_settings() -> str:
    """Code of the error of the environment as it is; empty without one."""
    try:
        deployment_settings()
    except BadInput as error:
        return error.code
    return ""


@pytest.mark.parametrize("words", [("serve", "--port", "0"), ("worker", "--check"), ("keys", "list")])
def test_commands_that_read_the_settings_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: tuple[str, ...]
) -> None:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(tmp_path))
    monkeypatch.setenv(WRONG, "1")
    assert main(words) == exits.BAD_INPUT
    assert f"did you mean '{PREFIX}MAX_ACTIVE'?" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_server_that_calls_the_factory_ends(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(tmp_path))
    monkeypatch.setenv(WRONG, "1")
    command = [sys.executable, "-m", "uvicorn", "--factory", "api.app:create_app", "--port", "0"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 2
    assert "MAX_ACTIVE" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("given", "path"), [("", ""), ("/", ""), ("/blades", "/blades"), ("/a/b-1/", "/a/b-1"), ("/a/.b", "/a/.b")]
)
def test_a_path_of_a_proxy(monkeypatch: pytest.MonkeyPatch, given: str, path: str) -> None:
    monkeypatch.setenv(f"{PREFIX}ROOT_PATH", given)
    assert deployment_settings().root_path == path


NO_PATHS = ["blades", "https://host/blades", "/a//b", "/a/../b", "/a/.", "/a b", "/ä", "/a?b"]


@pytest.mark.parametrize("given", NO_PATHS)
def test_what_is_no_path_of_a_proxy(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], given: str
) -> None:
    monkeypatch.setenv(f"{PREFIX}ROOT_PATH", given)
    with pytest.raises(BadInput, match="ROOT_PATH: must be a path such as /blades"):
        deployment_settings()
    monkeypatch.delenv(f"{PREFIX}ROOT_PATH")
    assert main(["serve", "--root-path", given]) == exits.BAD_INPUT
    assert "must be a path such as /blades" in capsys.readouterr().err
