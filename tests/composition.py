"""Runs the services of the compose files as processes: their commands, environments, health checks and start order.

What containers give is stood in for: names of hosts, ports, mounted folders and secrets are replaced by those of a test
folder; programs of the images come from this machine; and where the kernel lets us, our own programs see a root that
cannot be written, and have no capabilities.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from bench.soak.servers import free_port
from tests.signals import heed_interrupts

ROOT = Path(__file__).resolve().parents[1]
OWN = ("init", "api", "worker", "worker-gpu")
_VARIABLE = re.compile(r"\$(?:(\$)|\{(\w+)(?::-([^}]*))?\})")
_HOSTS = {"postgres": 5432, "redis": 6379}
_HERE = re.compile(r"\bpostgres:5432\b|\bredis:6379\b|\b8000\b|/run/secrets/|(?<![\w.])/(?:data|artifacts|tmp)\b")
_CONFINED = """
for folder in $WRITABLE; do mount --bind "$folder" "$folder"; done
while read -r _ _ _ _ point _; do
  case "$point" in /proc* | /dev*) continue ;; esac
  case " $WRITABLE " in *" $point "*) continue ;; esac
  mount -o remount,bind,ro "$point" 2> /dev/null || true
done < /proc/self/mountinfo
exec setpriv --bounding-set -all --inh-caps -all --no-new-privs -- "$@"
"""
"""Runs `$@` where nothing but `$WRITABLE` can be written, and without capabilities: `read_only` and `cap_drop`."""


def interpolated(value: Any, variables: Mapping[str, str]) -> Any:
    """A value of a compose file with ``${NAME:-default}`` replaced and ``$$`` read as ``$``."""
    if isinstance(value, str):
        return _VARIABLE.sub(lambda m: "$" if m[1] else variables.get(m[2]) or m[3] or "", value)
    if isinstance(value, Mapping):
        return {key: interpolated(one, variables) for key, one in value.items()}
    return [interpolated(one, variables) for one in value] if isinstance(value, list) else value


def merged(files: Sequence[str], variables: Mapping[str, str]) -> dict[str, Any]:
    """What Compose makes of several files: maps are joined, lists too, other values replaced."""
    result: dict[str, Any] = {}
    for name in files:
        result = _joined(result, interpolated(yaml.safe_load((ROOT / name).read_text("utf-8")), variables))
    return result


def _joined(old: Any, new: Any) -> Any:
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        return {**old, **{key: _joined(old[key], value) if key in old else value for key, value in new.items()}}
    return [*old, *new] if isinstance(old, list) and isinstance(new, list) else new


def image_environment() -> dict[str, str]:
    """What the Dockerfile sets for every process, but for where its programs are."""
    text = (ROOT / "Dockerfile").read_text("utf-8").replace("\\\n", " ")
    pairs = [pair for line in re.findall(r"^ENV (.*)$", text, re.MULTILINE) for pair in line.split()]
    return {name: value for name, _, value in (pair.partition("=") for pair in pairs) if name != "PATH"}


def start_order(services: Mapping[str, Any]) -> list[str]:
    """Names of services, each after those that it waits for."""
    order: list[str] = []

    def visit(name: str, above: tuple[str, ...]) -> None:
        assert name not in above, f"a circle: {above}"
        for needed in services[name].get("depends_on", {}):
            visit(needed, (*above, name))
        if name not in order:
            order.append(name)

    for name in services:
        visit(name, ())
    return order


@cache
def can_confine() -> bool:
    """True where this process may make a file system of its own for a child."""
    command = ["unshare", "--mount", "sh", "-c", "mount --bind /tmp /tmp && setpriv --bounding-set -all true"]
    programs = all(shutil.which(name) for name in ("unshare", "setpriv"))
    return programs and subprocess.run(command, capture_output=True, check=False).returncode == 0


@dataclass
class Composition:
    """The services of compose files in a test folder."""

    root: Path
    files: Sequence[str] = ("docker-compose.yml",)
    variables: Mapping[str, str] = field(default_factory=dict)
    """What a `.env` file would set."""
    added: Mapping[str, str] = field(default_factory=dict)
    """Further environment of our own services."""
    processes: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.whole = merged(self.files, self.variables)
        self.services: dict[str, Any] = self.whole["services"]
        self.ports = {"postgres": free_port(), "redis": free_port(), "api": free_port()}
        self.secrets = self.root / "secrets"
        for folder in (self.secrets, self.root / "programs", self.root / "logs"):
            folder.mkdir(parents=True, exist_ok=True)
        self._programs()

    def _programs(self) -> None:
        """Programs that the images have, on the ports of this test."""
        bins = {
            "python": f'exec {sys.executable} "$@"',
            "bladeatlas": f'exec {sys.executable} -m cli.main "$@"',
            "redis-server": f'exec {_found("redis-server")} "$@" --bind 127.0.0.1 --port {self.ports["redis"]}',
            "redis-cli": f'exec {_found("redis-cli")} -p {self.ports["redis"]} "$@"',
            "pg_isready": f'exec {_found("pg_isready")} -h 127.0.0.1 -p {self.ports["postgres"]} "$@"',
        }
        for name, line in bins.items():
            path = self.root / "programs" / name
            path.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
            path.chmod(0o755)

    def _here(self, text: str, name: str) -> str:
        """A text of a service with what containers give replaced by what is here, in one pass."""
        known = {f"{host}:{port}": f"127.0.0.1:{self.ports[host]}" for host, port in _HOSTS.items()}
        known |= {"8000": str(self.ports["api"]), "/run/secrets/": f"{self.secrets}/"}
        return _HERE.sub(lambda m: known.get(m[0]) or str(self.folder(name, m[0])), text)

    def folder(self, name: str, target: str) -> Path:
        """Where the mounted folder `target` of a service lies; it must be mounted."""
        service = self.services[name]
        volumes: dict[str, str] = {
            path: volume for volume, _, path in (str(one).partition(":") for one in service.get("volumes", ()))
        }
        if target in volumes:
            path = self.root / "volumes" / volumes[target]
        else:
            assert target in service.get("tmpfs", ()), f"{name} has nothing mounted at {target}"
            path = self.root / "tmpfs" / f"{name}{target}"
        path.mkdir(parents=True, exist_ok=True)
        return path

    def environment(self, name: str) -> dict[str, str]:
        """What a service's processes have in their environment."""
        service = self.services[name]
        here = {key: self._here(str(value), name) for key, value in service.get("environment", {}).items()}
        for key, value in here.items():
            secret = str(service["environment"][key])
            if secret.startswith("/run/secrets/"):
                assert secret.rpartition("/")[2] in service["secrets"], f"{name} has no secret for {key}"
                assert Path(value).is_file(), f"{value} is missing"
        inherited = {key: value for key, value in os.environ.items() if not key.startswith("BLADEATLAS_")}
        inherited["PATH"] = f"{self.root / 'programs'}:{os.environ['PATH']}"
        if name in OWN:
            image = {"TMPDIR": "/tmp", **image_environment()}
            inherited |= {key: self._here(value, name) for key, value in image.items()} | dict(self.added)
        return {**inherited, **here}

    def command(self, name: str, words: Sequence[str]) -> list[str]:
        """How a command of a service is run here."""
        command = [self._here(word, name) for word in words]
        return ["unshare", "--mount", "sh", "-c", _CONFINED, "sh", *command] if self.confined(name) else command

    def confined(self, name: str) -> bool:
        """True when a service is to have a read-only root, and that is possible here."""
        return name in OWN and bool(self.services[name].get("read_only")) and can_confine()

    def popen(self, name: str, words: Sequence[str], log: str) -> subprocess.Popen[bytes]:
        """Start a command of a service; what it says goes to logs."""
        service = self.services[name]
        mounted = [one.partition(":")[2] for one in service.get("volumes", ())] + service.get("tmpfs", [])
        environment = self.environment(name)
        if name in OWN:
            environment["WRITABLE"] = " ".join(str(self.folder(name, target)) for target in mounted)
        with self.said_path(log).open("ab") as out, self.said_path(f"{log}-err").open("ab") as err:
            return subprocess.Popen(
                self.command(name, words),
                cwd=ROOT,
                env=environment,
                stdout=out,
                stderr=err,
                preexec_fn=heed_interrupts,
                start_new_session=True,
            )

    def said_path(self, log: str) -> Path:
        """Where the output of a service goes."""
        return self.root / "logs" / log

    def said(self, log: str) -> str:
        """What a service has printed."""
        return self.said_path(log).read_text(errors="replace") if self.said_path(log).exists() else ""

    def start(self, name: str) -> None:
        """Start a service as soon as what it depends on is as far as it says; returns at once."""
        for needed, how in self.services[name].get("depends_on", {}).items():
            if how["condition"] == "service_healthy":
                self.wait_healthy(needed)
            else:
                assert how["condition"] == "service_completed_successfully"
                assert self.processes[needed].wait(90) == 0, self.said(f"{needed}-err")
        if name == "postgres":
            self.processes[name] = self._postgres()
        else:
            self.processes[name] = self.popen(name, self.services[name]["command"], name)

    def is_healthy(self, name: str) -> bool:
        """Run the health check of a service."""
        kind, *words = self.services[name]["healthcheck"]["test"]
        assert kind == "CMD"
        seconds = float(self.services[name]["healthcheck"]["timeout"].removesuffix("s"))
        process = self.popen(name, words, f"{name}-check")
        try:
            return process.wait(seconds * 3) == 0  # other tests may use the cores meanwhile
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return False

    def wait_healthy(self, name: str, seconds: float = 90.0) -> None:
        """Wait for the health check of a service, for as long as it runs."""
        deadline = time.monotonic() + seconds
        while not self.is_healthy(name):
            assert self.processes[name].poll() is None, f"{name} ended: {self.said(f'{name}-err')}"
            assert time.monotonic() < deadline, f"{name} is not healthy: {self.said(f'{name}-check-err')}"
            time.sleep(0.2)

    def _postgres(self) -> subprocess.Popen[bytes]:
        """What the image's entry point does with its variables: a cluster with one user, its password and database."""
        environment = self.environment("postgres")
        user = "postgres" if os.geteuid() == 0 else None
        folder = Path(f"/tmp/bladeatlas-{os.getpid()}-{self.ports['postgres']}")  # another user must reach it
        folder.mkdir()
        self._cluster = folder
        shutil.copy(environment["POSTGRES_PASSWORD_FILE"], folder / "password")
        if user:
            for path in (folder, folder / "password"):
                shutil.chown(path, user, user)
        name, data = environment["POSTGRES_USER"], folder / "data"
        made = ["-D", str(data), "-U", name, "-A", "scram-sha-256", "--pwfile", str(folder / "password"), "--no-sync"]
        subprocess.run([_found("initdb"), *made], check=True, user=user, cwd=folder, stdout=subprocess.DEVNULL)
        sql = f'CREATE DATABASE "{environment["POSTGRES_DB"]}"'
        single = [_found("postgres"), "--single", "-D", str(data), "template1"]
        subprocess.run(single, input=sql, text=True, check=True, user=user, cwd=folder, stdout=subprocess.DEVNULL)
        options = ["-c", "listen_addresses=127.0.0.1", "-c", "unix_socket_directories=", "-c", "log_connections=on"]
        with self.said_path("postgres-err").open("ab") as log:
            command = [_found("postgres"), "-D", str(data), "-p", str(self.ports["postgres"]), *options]
            return subprocess.Popen(command, user=user, cwd=folder, stdout=log, stderr=log)

    def stop(self) -> None:
        """End everything."""
        for name in reversed(self.processes):
            process = self.processes[name]
            if process.poll() is None:
                process.terminate()
                try:
                    process.wait(20)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        if hasattr(self, "_cluster"):
            shutil.rmtree(self._cluster, ignore_errors=True)


@contextmanager
def composed(
    root: Path, files: Sequence[str], variables: Mapping[str, str], added: Mapping[str, str]
) -> Iterator[Composition]:
    """Services that are stopped in the end."""
    made = Composition(root, files, variables, added)
    try:
        yield made
    finally:
        made.stop()


def _found(program: str) -> str:
    """A program of this machine, or where Debian keeps those of PostgreSQL."""
    versions = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{program}"))
    found = shutil.which(program) or (str(versions[-1]) if versions else "")
    assert found, f"{program} is not installed"
    return found
