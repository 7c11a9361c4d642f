"""Variables of the environment: those that nothing reads end the program, and the right name is told."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from cli import exits
from cli.main import main
from core.errors import BadInput
from store.settings import PREFIX, deployment_settings
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
    for name, value in (("MAX_ACTIVE", "secret"), ("ARTIFACTS_OPTIONS", "{secret")):
        monkeypatch.setenv(PREFIX + name, value)
        with pytest.raises(BadInput, match=f"(?i){name}") as caught:
            deployment_settings()
        assert "secret" not in caught.value.message
        monkeypatch.delenv(PREFIX + name)


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
