"""Deployment settings: what differs between machines, `BLADEATLAS_*` of the environment, never part of a fingerprint.

`store.environment` reads them.
"""

from __future__ import annotations

import os
import re
from ipaddress import IPv4Network, IPv6Network, ip_network
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

from pydantic import Field, SecretStr, ValidationInfo, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict
from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from core.review.words import SEVERITIES
from core.video.limits import MAX_FRAME_PIXELS

PREFIX = "BLADEATLAS_"
_ORIGIN = re.compile(r"https?://[a-z0-9.-]+(:\d{1,5})?|https?://\[[0-9a-f:.]+\](:\d{1,5})?")
_HOSTS = re.compile(r"(\*\.)?[A-Za-z0-9][A-Za-z0-9.-]*(:[0-9]{1,5})?")
_BUCKET = re.compile(r"[a-z0-9][a-z0-9.-]{1,61}[a-z0-9](/(?!\.{1,2}(/|$))[^/?#\s]+)*/?")
_PREFIX_PATH = re.compile(r"(/(?!\.{1,2}(/|$))[A-Za-z0-9._~-]+)*/?")
_BROKERS = ("redis", "rediss", "redis+socket", "sentinel", "amqp", "amqps", "pyamqp")
_HOST = re.compile(r"[\w.:,\[\]-]*")
_NO_SECRET = SecretStr("")


class DeploymentSettings(BaseSettings):
    """Where things are kept and how work is leased; every field is one environment variable."""

    model_config = SettingsConfigDict(env_prefix="BLADEATLAS_", frozen=True, extra="ignore")

    data_dir: Path = Field(
        Path("bladeatlas-data"), description="local folder: uploads, and all else unless configured otherwise"
    )
    database_url: str = Field(
        "", repr=False, description="postgresql://user@host/name; empty = SQLite in the data folder"
    )
    database_password: SecretStr = Field(
        _NO_SECRET, description="password for it, as it is: in the URL itself `@ : / %` and others must be encoded"
    )
    workers: int = Field(0, ge=0, description="tasks side by side; 0 = number of cores")
    lease_s: float = Field(30.0, gt=0, description="a lease without a heartbeat ends after this, in seconds")
    heartbeat_s: float = Field(10.0, gt=0, description="leases are renewed this often, in seconds")
    max_attempts: int = Field(3, ge=1, description="attempts of a task that loses its process or a resource")
    task_memory_bytes: int = Field(
        0, ge=0, description="a task above this resident size is ended (oom) and not tried again; 0 = no limit"
    )
    task_seconds: float = Field(
        14_400.0, gt=0, description="a task that runs longer is ended (timeout) and not tried again, in seconds"
    )
    task_address_bytes: int = Field(
        64 << 30,
        ge=0,
        description="address space of a process of a task (RLIMIT_AS), which is more than the memory that it uses; "
        "beyond it the task fails (oom); not for the queue gpu, whose drivers reserve more; 0 = no limit",
    )
    task_cpu_seconds: float = Field(
        0.0,
        ge=0,
        description="processor time of a process of a task (RLIMIT_CPU), all threads together, in seconds; beyond it "
        "the task is ended (timeout); 0 = task_seconds on each thread",
    )
    task_file_bytes: int = Field(
        16 << 30,
        ge=0,
        description="largest file that a task writes (RLIMIT_FSIZE); beyond it the task fails (file_too_large); "
        "0 = no limit",
    )
    artifacts_url: str = Field(
        "", description="where files are kept: s3://bucket/prefix or file:///shared (fsspec); empty = data folder"
    )
    artifacts_endpoint: str = Field("", description="address of the S3 server; empty = Amazon's")
    artifacts_key: SecretStr = Field(_NO_SECRET, description="access key of the S3 server; empty = as boto3 finds it")
    artifacts_secret: SecretStr = Field(_NO_SECRET, description="the secret that belongs to the key")
    artifacts_options: dict[str, Any] = Field({}, repr=False, description="further options of fsspec, as JSON")
    broker_url: str = Field(
        "",
        repr=False,
        description="redis://host/0 or amqp://user@host; empty = runners in the server, and workers ask the database",
    )
    broker_password: SecretStr = Field(_NO_SECRET, description="password for it, as it is")
    visibility_timeout_s: float = Field(
        21_600.0,
        gt=0,
        description="the broker hands an unacknowledged message out again after this, in seconds; early is harmless",
    )
    sweep_s: float = Field(10.0, gt=0, description="what was lost is looked for this often, in seconds")
    stale_s: float = Field(
        600.0, ge=0, description="files that belong to nothing are removed after so long, in seconds"
    )
    retention_days: float = Field(30.0, ge=0, description="an inspection is removed so long after it ended; 0 = never")
    report_style: Path | None = Field(
        None, description="folder of the house style of reports (docs/report.md); none = the plain one"
    )
    upload_hours: float = Field(72.0, gt=0, description="an upload that nobody used is removed after this")
    reserve_bytes: int = Field(
        2 << 30, ge=0, description="free space below which new work is refused (507); what runs goes on"
    )
    max_upload_bytes: int = Field(64 << 30, ge=1, description="largest upload")
    max_annotations_bytes: int = Field(128 << 20, ge=1, description="largest annotation file")
    max_active: int = Field(100, ge=1, description="inspections queued or running, at most; more get 429")
    max_active_per_owner: int = Field(
        50, ge=1, description="the same of one owner, that is one account; an account may have limits of its own"
    )
    max_open_uploads: int = Field(
        1000, ge=1, description="unfinished uploads, and forms while they come in, at most; more get 429"
    )
    max_open_uploads_per_owner: int = Field(100, ge=1, description="the same of one owner")
    max_promised_bytes: int = Field(
        0, ge=0, description="bytes that open uploads and forms may still send, at most; 0 = as the disk has room"
    )
    max_promised_bytes_per_owner: int = Field(
        256 << 30, ge=0, description="the same of one owner; 0 = no limit, more get 429"
    )
    max_kept_bytes: int = Field(
        0, ge=0, description="bytes of uploads, inputs and published files, at most; 0 = as the disk has room"
    )
    max_kept_bytes_per_owner: int = Field(0, ge=0, description="the same of one owner; 0 = no limit, more get 429")
    max_requests_per_minute: int = Field(
        0, ge=0, description="requests answered in a minute of the clock, by all servers together; 0 = no limit"
    )
    max_requests_per_minute_per_owner: int = Field(
        0, ge=0, description="the same of one owner; 0 = no limit, more get 429"
    )
    share_results: bool = Field(
        False,
        description="an account takes up finished results of others for the same input; a fast answer then tells that "
        "others had it",
    )
    audit_days: float = Field(365.0, gt=0, description="the audit log is kept so long, in days")
    event_days: float = Field(30.0, gt=0, description="events are kept so long, in days")
    max_event_streams: int = Field(
        500, ge=1, description="streams of events that one server keeps open, at most; more get 429"
    )
    max_event_streams_per_owner: int = Field(20, ge=1, description="the same of one owner")
    max_frame_pixels: int = Field(
        MAX_FRAME_PIXELS,
        ge=1,
        description="largest picture of a video, in pixels; stages hold to it: set it for workers too",
    )
    max_video_frames: int = Field(500_000, ge=1, description="frames that a video's header may state")
    max_video_seconds: float = Field(21_600.0, gt=0, description="length that a video's header may state, in seconds")
    probe_seconds: float = Field(8.0, gt=0, description="processor time to look into an uploaded video, in seconds")
    probe_memory_bytes: int = Field(2 << 30, gt=0, description="memory limit of the same")
    probe_wait_seconds: float = Field(
        60.0, gt=0, description="two looks into videos run at a time, a third for an owner with none; then it is 503"
    )
    max_probes_waiting: int = Field(
        200, ge=0, description="requests of one server that wait for such a look, at most; more get 503"
    )
    max_probes_waiting_per_owner: int = Field(50, ge=0, description="the same of one owner; more get 429")

    severities: str = Field(
        ",".join(SEVERITIES), description="what a reviewer may say shall be done about a finding, separated by commas"
    )
    max_connections: int = Field(
        2000,
        ge=1,
        description="open connections of one server, at most; beyond it those give way that have sent no whole request",
    )
    header_seconds: float = Field(
        15.0, gt=0, description="a connection that has sent no whole request header by then is closed, in seconds"
    )
    outbound_networks: str = Field(
        "",
        description="networks that are not public and may be called nevertheless, by webhooks and for inputs, e.g. "
        "10.1.0.0/16,fd00::/8; without TLS only these",
    )
    input_buckets: str = Field(
        "",
        description="buckets of the S3 server of the artifacts that every account may have inputs fetched from: "
        "incoming,archive/borescope; empty = none",
    )
    input_hosts: str = Field(
        "",
        description="hosts that inputs may be fetched from by https: files.example.com,*.example.org,host:8443; "
        "empty = none",
    )
    fetch_seconds: float = Field(3600.0, gt=0, description="a file that takes longer to fetch is refused, in seconds")
    max_fetches: int = Field(16, ge=1, description="requests of one server that fetch inputs at once; more get 429")
    max_fetches_per_owner: int = Field(4, ge=1, description="the same of one owner")
    max_webhooks_per_owner: int = Field(20, ge=0, description="webhooks of one account; more get 429")
    webhook_seconds: float = Field(15.0, gt=0, le=60, description="a receiver must have answered within this")
    webhook_hours: float = Field(24.0, gt=0, description="an event that was not delivered so long is given up")

    root_path: str = Field(
        "",
        description="the path that a proxy before the server takes off, e.g. /blades; the same as `serve --root-path`",
    )
    trusted_hosts: str = Field(
        "",
        description="with API keys: names that the server goes by beside loopback, separated by commas; others get "
        "421; empty = any",
    )
    no_auth: bool = Field(
        False,
        description="whoever reaches the server may read and submit without a key, as the account default; keys still "
        "work. For networks where a proxy or nobody else decides who may call; the same as `serve --no-auth`",
    )
    cors_origins: str = Field(
        "",
        description="with API keys: origins whose pages may call this server, e.g. https://front.example.com, "
        "separated by commas; empty = none",
    )
    graph: str = Field("store.graph:CORE_GRAPH", description="stage graph as module:name; another one in trials")

    @field_validator("database_url")
    @classmethod
    def _database_is_an_address(cls, value: str) -> str:
        if value:
            try:
                parsed = make_url(value)
            except (ArgumentError, ValueError):
                raise ValueError(_not_an_address("DATABASE")) from None
            if not _HOST.fullmatch(parsed.host or ""):
                raise ValueError(_not_an_address("DATABASE"))
        return value

    @field_validator("broker_url")
    @classmethod
    def _broker_is_an_address(cls, value: str) -> str:
        if value:
            scheme = value.partition("://")[0]
            if scheme not in _BROKERS:
                # Without the separator the whole text would be repeated, and it may hold a password.
                said = f"'{scheme}' is" if re.fullmatch(r"[a-z0-9+]{1,20}", scheme) and "://" in value else "it names"
                raise ValueError(f"{said} no kind of broker; known: {', '.join(_BROKERS)}")
            try:
                parts = urlsplit(value)
                valid = parts.port != 0 and not parts.fragment and _HOST.fullmatch(parts.hostname or "")
            except ValueError:
                valid = None
            if not valid:
                raise ValueError(_not_an_address("BROKER"))
        return value

    @field_validator("outbound_networks")
    @classmethod
    def _are_networks(cls, value: str) -> str:
        try:
            _networks(value)
        except ValueError:  # whose words repeat the value
            raise ValueError("must be networks such as 10.1.0.0/16, separated by commas") from None
        return value

    @field_validator("input_hosts")
    @classmethod
    def _are_hosts(cls, value: str) -> str:
        if not all(_HOSTS.fullmatch(part.strip()) for part in value.split(",") if part.strip()):
            raise ValueError("must be host, host:port or *.domain, separated by commas")
        return value

    @field_validator("input_buckets")
    @classmethod
    def _are_buckets(cls, value: str, told: ValidationInfo) -> str:
        store = str(told.data.get("artifacts_url", ""))
        for part in filter(None, (part.strip() for part in value.split(","))):
            if not _BUCKET.fullmatch(part):
                raise ValueError("must be bucket or bucket/prefix, separated by commas")
            place, own = f"{part.rstrip('/')}/", f"{store.removeprefix('s3://').rstrip('/')}/"
            if store.startswith("s3://") and (place.startswith(own) or own.startswith(place)):
                # Every account may read these buckets, and the store holds what belongs to each.
                raise ValueError("must not hold the artifact store, or a part of it")
        return value

    @field_validator("root_path")
    @classmethod
    def _is_a_prefix(cls, value: str) -> str:
        return prefix_path(value)

    def allowed_networks(self) -> tuple[IPv4Network | IPv6Network, ...]:
        """Networks that are not public and may be called nevertheless."""
        return _networks(self.outbound_networks)

    def folder(self, name: str) -> Path:
        """A folder of the data folder."""
        return self.data_dir.absolute() / name

    def database(self) -> str | URL:
        """URL of the database, with its password."""
        if not self.database_url:
            return URL.create("sqlite+pysqlite", database=str(self.folder("bladeatlas.db")))
        password = self.database_password.get_secret_value()
        return make_url(self.database_url).set(password=password) if password else self.database_url

    def broker(self) -> str:
        """URL of the broker, with its password; empty = there is none."""
        password = self.broker_password.get_secret_value()
        if not self.broker_url or not password:
            return self.broker_url
        scheme, _, rest = self.broker_url.partition("://")
        user, at, host = rest.rpartition("@")
        name = user.partition(":")[0] if at else ""
        return f"{scheme}://{name}:{quote(password, safe='')}@{host}"

    def storage_options(self) -> dict[str, Any]:
        """What fsspec must know to reach the artifact store."""
        options = dict(self.artifacts_options)
        if self.artifacts_key.get_secret_value():
            options["key"] = self.artifacts_key.get_secret_value()
        if self.artifacts_secret.get_secret_value():
            options["secret"] = self.artifacts_secret.get_secret_value()
        if self.artifacts_endpoint:
            options["client_kwargs"] = {**options.get("client_kwargs", {}), "endpoint_url": self.artifacts_endpoint}
        return options

    def artifacts(self) -> Path | str:
        """Root of the artifact store: a folder, or a URL."""
        return self.artifacts_url or self.folder("artifacts")

    def host_names(self) -> frozenset[str]:
        """Names that the server goes by; empty = any."""
        return frozenset(name.strip().lower() for name in self.trusted_hosts.split(",") if name.strip())

    def severity_names(self) -> tuple[str, ...]:
        """What a reviewer may say shall be done about a finding, in this order."""
        return tuple(dict.fromkeys(name.strip() for name in self.severities.split(",") if name.strip()))

    def origins(self) -> list[str]:
        """Origins of foreign pages that may call."""
        return [origin.strip() for origin in self.cors_origins.split(",") if origin.strip()]

    @field_validator("cors_origins")
    @classmethod
    def _are_origins(cls, value: str) -> str:
        for origin in filter(None, (part.strip() for part in value.split(","))):
            if not _ORIGIN.fullmatch(origin):
                raise ValueError("an origin is https://name or https://name:port, without a path and in small letters")
        return value

    def worker_count(self) -> int:
        """Number of tasks side by side."""
        return self.workers or available_cores()


def _networks(text: str) -> tuple[IPv4Network | IPv6Network, ...]:
    """Networks separated by commas; ValueError for what is none."""
    return tuple(ip_network(part.strip()) for part in text.split(",") if part.strip())


def prefix_path(text: str) -> str:
    """A path of a proxy without a slash at its end, empty for the root; ValueError for what is none."""
    if not _PREFIX_PATH.fullmatch(text):
        raise ValueError("must be a path such as /blades, of letters, digits, `-`, `_`, `.` and `~`")
    return text.rstrip("/")


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _not_an_address(what: str) -> str:
    return f"is not an address; a password with special characters belongs into {PREFIX}{what}_PASSWORD"
