"""What a confined process cannot do any more, tried by real processes."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from core.child_environment import child_environment
from core.confinement import NetworkGuard, possible_guard

_BEGIN = """
import ctypes, json, os, resource, socket, subprocess, sys, threading
from core import confinement
from core.confinement import NetworkGuard, ProcessLimits, confine, hide_memory

def outcome(call):
    try:
        call()
    except OSError as error:
        return type(error).__name__
    return "done"
"""
_WITHOUT = {
    NetworkGuard.SECCOMP: "",
    NetworkGuard.NAMESPACE: "confinement._CALLS.clear()",
}
"""What a machine lacks whose best guard is this one."""


def said_by(script: str, *arguments: object) -> dict[str, Any]:
    """What a process that runs `script` prints as JSON."""
    command = [sys.executable, "-c", _BEGIN + script, *map(str, arguments)]
    ended = subprocess.run(command, env=child_environment(1), capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode == 0, ended.stderr
    found: dict[str, Any] = json.loads(ended.stdout)
    return found


@pytest.fixture
def listening(tmp_path: Path) -> Iterator[tuple[int, Path]]:
    """A port and a socket's path on which somebody listens."""
    path = tmp_path / "s"
    with socket.socket() as tcp, socket.socket(socket.AF_UNIX) as unix:
        tcp.bind(("127.0.0.1", 0))
        unix.bind(str(path))
        for one in (tcp, unix):
            one.listen()
        yield tcp.getsockname()[1], path


_REACH = """
port, path = int(sys.argv[1]), sys.argv[2]
tcp = lambda: socket.create_connection(("127.0.0.1", port), timeout=5)
before = outcome(tcp)
{without}
guard = confine(ProcessLimits())
def unix():
    socket.socket(socket.AF_UNIX).connect(path)
in_thread = []
thread = threading.Thread(target=lambda: in_thread.append(outcome(tcp)))
thread.start(); thread.join()
helper = "import socket, sys; socket.create_connection(('127.0.0.1', int(sys.argv[1])), timeout=5)"
helper = subprocess.run([sys.executable, "-c", helper, str(port)], stderr=subprocess.DEVNULL).returncode
a, b = socket.socketpair(); a.send(b"x")
print(json.dumps(dict(before=before, guard=guard, tcp=outcome(tcp), unix=outcome(unix), thread=in_thread[0],
                      helper=helper, pair=b.recv(1).decode())))
"""


@pytest.mark.parametrize("guard", [NetworkGuard.SECCOMP, NetworkGuard.NAMESPACE])
def test_nobody_who_listens_is_reached(guard: NetworkGuard, listening: tuple[int, Path]) -> None:
    said = said_by(_REACH.replace("{without}", _WITHOUT[guard]), *listening)
    if said["guard"] == NetworkGuard.NONE:
        pytest.skip("this system allows neither seccomp filters nor network namespaces")
    assert said["guard"] == guard
    assert said["before"] == "done", "it is the guard that keeps it away"
    refused = {NetworkGuard.SECCOMP: "PermissionError", NetworkGuard.NAMESPACE: "OSError"}[guard]
    assert said["tcp"] == said["thread"] == refused
    assert said["helper"] != 0, "what it starts is confined too"
    assert said["pair"] == "x", "processes that belong together still talk"
    if guard == NetworkGuard.SECCOMP:
        assert said["unix"] == "PermissionError"


def test_where_nothing_is_allowed_it_says_so(listening: tuple[int, Path]) -> None:
    without = "confinement._CALLS.clear(); confinement._CLONE_NEWNET = confinement._CLONE_NEWUSER = 1  # no such flag"
    said = said_by(_REACH.replace("{without}", without), *listening)
    assert (said["guard"], said["tcp"]) == (NetworkGuard.NONE, "done")


def test_privileges_are_gone_for_good() -> None:
    said = said_by("""
confine(ProcessLimits())
status = dict(line.split(":\\t", 1) for line in open("/proc/self/status").read().splitlines())
helper = subprocess.run(["cat", "/proc/self/status"], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout
started = dict(line.split(":\\t", 1) for line in helper.splitlines())
print(json.dumps([status[name] for name in ("NoNewPrivs", "CapEff")] + [started["CapEff"]]))
""")
    no_new, own, helpers = said
    assert no_new == "1"
    assert int(own, 16) & ~0b1111 == 0, "nothing but the rights of root over files"
    assert int(helpers, 16) & ~int(own, 16) == 0, "a program that it starts gets nothing back"


_READ_PARENT = """
if os.getuid() == 0:
    os.setgid(65534); os.setuid(65534)
    ctypes.CDLL(None).prctl(4, 1, 0, 0, 0)  # as after exec: another user's process is not hidden by itself
if sys.argv[1] == "hidden":
    hide_memory()
read, write = os.pipe()
if os.fork() == 0:
    ctypes.CDLL(None).prctl(4, 1, 0, 0, 0)
    confine(ProcessLimits())
    os.write(write, outcome(lambda: open(f"/proc/{os.getppid()}/environ").read()).encode())
    os._exit(0)
os.wait()
print(json.dumps({"read": os.read(read, 100).decode()}))
"""


@pytest.mark.parametrize(("how", "outcome"), [("hidden", "PermissionError"), ("open", "done")])
def test_a_child_cannot_read_the_credentials_of_its_parent(how: str, outcome: str) -> None:
    assert said_by(_READ_PARENT, how)["read"] == outcome


def test_limits_are_the_kernels_and_only_ever_lowered() -> None:
    said = said_by("""
confine(ProcessLimits(address_bytes=4 << 30, cpu_s=100, file_bytes=1 << 20))
confine(ProcessLimits(address_bytes=8 << 30, cpu_s=50))
names = ("RLIMIT_AS", "RLIMIT_CPU", "RLIMIT_FSIZE", "RLIMIT_CORE")
print(json.dumps({name: resource.getrlimit(getattr(resource, name)) for name in names}))
""")
    assert said == {
        "RLIMIT_AS": [4 << 30, 4 << 30],
        "RLIMIT_CPU": [50, 51],
        "RLIMIT_FSIZE": [1 << 20, 1 << 20],
        "RLIMIT_CORE": [0, 0],
    }


def test_what_is_possible_here_is_what_a_child_gets() -> None:
    assert possible_guard() == said_by('print(json.dumps({"guard": confine(ProcessLimits())}))')["guard"]
