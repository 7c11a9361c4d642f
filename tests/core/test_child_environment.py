"""What a child process is told of its parent's environment."""

from __future__ import annotations

import pytest

from core.child_environment import child_environment

_SECRETS = (
    *("BLADEATLAS_DATABASE_URL", "BLADEATLAS_BROKER_URL", "BLADEATLAS_ARTIFACTS_OPTIONS", "BLADEATLAS_API_KEY"),
    *("AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN", "AWS_PROFILE", "GOOGLE_APPLICATION_CREDENTIALS"),
    *("PGPASSWORD", "PGPASSFILE", "DATABASE_URL", "REDIS_URL", "CELERY_BROKER_URL", "HTTPS_PROXY", "SSH_AUTH_SOCK"),
    *("NVIDIA_API_KEY", "CUDA_LICENSE_TOKEN", "OMP_SECRET", "PYTHONSTARTUP"),
)


@pytest.mark.parametrize("name", _SECRETS)
def test_credentials_stay_behind(name: str) -> None:
    assert "hidden" not in child_environment(1, {name: "hidden"}).values()


@pytest.mark.parametrize(
    "name",
    ["PATH", "HOME", "LANG", "LC_ALL", "TZ", "TMPDIR", "LD_LIBRARY_PATH", "CUDA_VISIBLE_DEVICES", "NUMBA_CACHE_DIR"],
)
def test_what_computing_needs_goes_along(name: str) -> None:
    assert child_environment(1, {name: "needed"})[name] == "needed"


def test_threads_are_those_of_the_task_and_the_program_is_found() -> None:
    made = child_environment(3, {"OMP_NUM_THREADS": "64", "PYTHONPATH": "/elsewhere"})
    assert {made[f"{library}_NUM_THREADS"] for library in ("OMP", "MKL", "OPENBLAS", "NUMBA")} == {"3"}
    assert made["PYTHONPATH"].endswith(":/elsewhere")
