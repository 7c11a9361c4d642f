"""Deployment settings: what differs between machines, read from `BLADEATLAS_*` and never part of a fingerprint."""

from __future__ import annotations

import os
from pathlib import Path

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict


class DeploymentSettings(BaseSettings):
    """Where things are kept and how work is leased; every field is one environment variable."""

    model_config = SettingsConfigDict(env_prefix="BLADEATLAS_", frozen=True, extra="ignore")

    data_dir: Path = Field(Path("bladeatlas-data"), description="folder of the embedded store")
    database_url: str = Field("", description="SQLAlchemy URL; empty = SQLite in the data folder")
    workers: int = Field(0, ge=0, description="tasks side by side; 0 = number of cores")
    lease_s: float = Field(30.0, gt=0, description="a lease without a heartbeat ends after this, in seconds")
    heartbeat_s: float = Field(10.0, gt=0, description="leases are renewed this often, in seconds")
    max_attempts: int = Field(3, ge=1, description="attempts of a task that loses its process or a resource")
    task_memory_bytes: int = Field(0, ge=0, description="a task above this resident size is ended (oom); 0 = no limit")

    def worker_count(self) -> int:
        """Number of tasks side by side."""
        return self.workers or available_cores()


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
