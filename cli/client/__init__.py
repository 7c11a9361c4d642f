"""A typed client of the service."""

from __future__ import annotations

from cli.client.client import Client
from cli.client.errors import ServerProblem
from cli.client.values import ArtifactInfo, InspectionInfo

__all__ = ["ArtifactInfo", "Client", "InspectionInfo", "ServerProblem"]
