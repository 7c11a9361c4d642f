"""What a process that reads strangers' files gives up before it reads them: the network, privileges, a larger share.

A decoder that a hostile file has taken over can then neither send what it finds nor ask a database or a cloud's
metadata service for more. All of it is taken away by the process itself, for itself and its own children, and can never
be taken back (`no_new_privs`). `python -m core.confinement` says in JSON what is possible here.

Sources: prctl(2), seccomp(2), capabilities(7), network_namespaces(7) and setrlimit(2) of the Linux manual.
"""

from __future__ import annotations

import ctypes
import json
import os
import platform
import resource
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import cache

from core.child_environment import child_environment

_PR_SET_PDEATHSIG, _PR_SET_DUMPABLE, _PR_SET_SECCOMP, _PR_SET_NO_NEW_PRIVS = 1, 4, 22, 38
_SECCOMP_MODE_FILTER = 2
_CLONE_NEWUSER, _CLONE_NEWNET = 0x10000000, 0x40000000
_CAPABILITY_VERSION = 0x20080522
_FILE_CAPABILITIES = 0b1111
"""CAP_CHOWN, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH and CAP_FOWNER: as root, folders of other users stay usable."""

_LOAD, _JUMP_IF_EQUAL, _JUMP_IF_SET, _RETURN = 0x20, 0x15, 0x45, 0x06
"""Instructions of the kernel's packet filter: load a word, compare, test bits, return."""
_ALLOW, _REFUSE, _KILL = 0x7FFF0000, 0x00050000 | 13, 0x80000000
"""Verdicts of a filter: go on, fail with EACCES, end the process."""
_NUMBER_AT, _ARCHITECTURE_AT = 0, 4
"""Where in `struct seccomp_data` the number of the call and the architecture stand."""
_X32_BIT = 0x40000000
"""Set in numbers of a second set of calls that 64-bit kernels of x86 may have."""


class NetworkGuard(StrEnum):
    """What keeps a child from the network."""

    SECCOMP = "seccomp"
    """The kernel refuses to make sockets."""
    NAMESPACE = "namespace"
    """It is in a network of its own that leads nowhere."""
    NONE = "none"
    """Nothing: this kernel, or what the service runs in, allows neither."""


@dataclass(frozen=True)
class ProcessLimits:
    """Limits that the kernel holds a process to, each of its own children too; 0 = none."""

    address_bytes: int = 0
    """Address space, which is more than the memory that is used."""
    cpu_s: int = 0
    """Processor time, summed over threads; SIGXCPU comes at its end."""
    file_bytes: int = 0
    """Largest file that is written."""


@dataclass(frozen=True)
class _Calls:
    """What a filter needs to know of an architecture."""

    architecture: int
    """AUDIT_ARCH_* of linux/audit.h."""
    refused: tuple[int, ...]
    """Numbers of `socket`, `ptrace`, `process_vm_readv`, `process_vm_writev`, `io_uring_setup` and `pidfd_getfd`.

    `io_uring` makes sockets without the call `socket`; the others reach into other processes.
    """


_CALLS = {
    "x86_64": _Calls(0xC000003E, (41, 101, 310, 311, 425, 438)),
    "aarch64": _Calls(0xC00000B7, (198, 117, 270, 271, 425, 438)),
}


class _Instruction(ctypes.Structure):
    _fields_ = (("code", ctypes.c_ushort), ("yes", ctypes.c_ubyte), ("no", ctypes.c_ubyte), ("value", ctypes.c_uint))


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.POINTER(_Instruction)))


class _CapabilityHeader(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint), ("pid", ctypes.c_int))


class _CapabilityWords(ctypes.Structure):
    _fields_ = (("effective", ctypes.c_uint), ("permitted", ctypes.c_uint), ("inheritable", ctypes.c_uint))


def confine(limits: ProcessLimits) -> NetworkGuard:
    """Give up privileges and the network, and take on limits; returns what keeps the network away.

    To be called while the process has one thread. A signal that was asked for at the parent's death is lost where a
    namespace is the guard, so `die_with` comes afterwards.
    """
    _prctl(_PR_SET_NO_NEW_PRIVS, 1)
    guard = _give_up_network()
    _give_up_capabilities()
    limit(limits)
    return guard


def limit(limits: ProcessLimits) -> None:
    """Take on limits; a lower one that the process has already stays. No memory of it is ever written to a file."""
    for what, value in ((resource.RLIMIT_AS, limits.address_bytes), (resource.RLIMIT_FSIZE, limits.file_bytes)):
        if value:
            _lower(what, value, value)
    if limits.cpu_s:
        _lower(resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 1)  # SIGXCPU, which tells why, comes before SIGKILL
    _lower(resource.RLIMIT_CORE, 0, 0)


def _lower(what: int, soft: int, hard: int) -> None:
    had = resource.getrlimit(what)
    wanted = [new if old == resource.RLIM_INFINITY else min(new, old) for new, old in ((soft, had[0]), (hard, had[1]))]
    resource.setrlimit(what, (wanted[0], wanted[1]))


def die_with(parent: int, with_signal: signal.Signals) -> None:
    """Ask the kernel for `with_signal` when the parent dies; leave at once if it is dead already."""
    _prctl(_PR_SET_PDEATHSIG, int(with_signal))
    if os.getppid() != parent:
        os._exit(1)


def hide_memory() -> None:
    """Keep what this process knows, its environment included, from other processes of the same user.

    Children are the user's processes too: without this one could read the credentials of its parent from /proc.
    """
    _prctl(_PR_SET_DUMPABLE, 0)


def _give_up_network() -> NetworkGuard:
    if _refuse_sockets():
        return NetworkGuard.SECCOMP
    unshare = ctypes.CDLL(None, use_errno=True).unshare
    # Root may do without a user namespace, in which its rights over files would end.
    if any(unshare(flags) == 0 for flags in (_CLONE_NEWNET, _CLONE_NEWNET | _CLONE_NEWUSER)):
        return NetworkGuard.NAMESPACE
    return NetworkGuard.NONE


def _refuse_sockets() -> bool:
    """Install a filter of system calls; False when there is none for this machine, or the kernel takes none."""
    calls = _CALLS.get(platform.machine())
    if calls is None or sys.maxsize < 1 << 32:
        return False
    lines = _filter(calls)
    listed = (_Instruction * len(lines))(*(_Instruction(*line) for line in lines))
    program = _Program(len(lines), listed)
    library = ctypes.CDLL(None, use_errno=True)
    return int(library.prctl(_PR_SET_SECCOMP, _SECCOMP_MODE_FILTER, ctypes.byref(program), 0, 0)) == 0


def _filter(calls: _Calls) -> list[tuple[int, int, int, int]]:
    """Instructions, each with how many to skip when its question is answered with yes, and with no."""
    refuse = len(calls.refused)
    questions = [(_JUMP_IF_EQUAL, refuse - at, 0, number) for at, number in enumerate(calls.refused)]
    return [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_JUMP_IF_EQUAL, 1, 0, calls.architecture),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER_AT),
        (_JUMP_IF_SET, refuse + 1, 0, _X32_BIT),
        *questions,
        (_RETURN, 0, 0, _ALLOW),
        (_RETURN, 0, 0, _REFUSE),
    ]


def _give_up_capabilities() -> None:
    """Of what root may do keep the rights over files; of other users nothing is left that could be kept."""
    library = ctypes.CDLL(None, use_errno=True)
    header, words = _CapabilityHeader(_CAPABILITY_VERSION, 0), (_CapabilityWords * 2)()
    if library.capget(ctypes.byref(header), words) != 0:
        return
    for word, kept in zip(words, (_FILE_CAPABILITIES, 0), strict=True):
        word.effective &= kept
        word.permitted &= kept
        word.inheritable = 0
    library.capset(ctypes.byref(header), words)


def _prctl(what: int, value: int) -> None:
    ctypes.CDLL(None, use_errno=True).prctl(what, value, 0, 0, 0)


@cache
def possible_guard() -> NetworkGuard:
    """What would keep a child of this process from the network; asked once, of a child."""
    with suppress(OSError, subprocess.SubprocessError, ValueError):
        command = [sys.executable, "-m", "core.confinement"]
        said = subprocess.run(command, env=child_environment(1), capture_output=True, timeout=60, check=True).stdout
        return NetworkGuard(json.loads(said)["network"])
    return NetworkGuard.NONE


def main() -> None:
    """Print what guards this process once it is confined."""
    json.dump({"network": confine(ProcessLimits())}, sys.stdout)


if __name__ == "__main__":
    main()
