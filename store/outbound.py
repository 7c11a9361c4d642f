"""Calls to servers that users name: only to addresses that may be called, and to the very address that was checked.

A name is looked up once for every call; all of its addresses must be allowed, and the connection goes to one of
these, so that a second look-up cannot lead elsewhere. Redirects are not followed, and proxies of the environment are
not used. What a call may take is one time for all of it, from the look-up to the last byte that is read.
"""

from __future__ import annotations

import ipaddress
import socket
import ssl
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network
from urllib.parse import SplitResult, urlsplit

import httpcore
import httpx

from core.errors import BadInput, ResourceError

MAX_URL = 2000
_CONNECT_S = 10.0
_PORTS = {"https": 443, "http": 80}
_NAT64 = IPv6Network("64:ff9b::/96")
_ERRORS = (httpcore.NetworkError, httpcore.TimeoutException, httpcore.ProtocolError)

Address = IPv4Address | IPv6Address
Network = IPv4Network | IPv6Network


class Unreachable(ResourceError):
    """Nobody answered, or not in time, or not in HTTP."""

    code = "unreachable"


def is_public(address: Address) -> bool:
    """True for an address of the public internet; one that carries another in itself is what that one is."""
    if isinstance(address, IPv6Address):
        inner = address.ipv4_mapped or address.sixtofour
        if inner is None and address in _NAT64:
            inner = IPv4Address(int(address) & 0xFFFFFFFF)
        if inner is not None:
            return is_public(inner)
        if address.teredo is not None or address.is_site_local:
            return False
    return address.is_global and not address.is_multicast


def look_up(host: str, port: int) -> Sequence[str]:
    """The addresses of a name, as the system says; OSError when it knows none."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(entry[4][0]) for entry in found))


def parse_url(url: str) -> SplitResult:
    """The parts of an absolute http(s) URL without a user, a password or a fragment.

    Raises:
        BadInput: `bad_url`, it is none.
    """
    try:
        parts = urlsplit(url)
        good = url.startswith(("https://", "http://")) and bool(parts.hostname) and parts.port != 0
    except ValueError:
        good = False
    # Checked as a whole: what a parser drops or reads in another way never reaches one.
    printable = all("!" <= character <= "~" for character in url) and "\\" not in url
    if not good or not printable or len(url) > MAX_URL or "@" in parts.netloc or "#" in url:
        message = f"this is no URL that can be called: https://host/path of ASCII letters, at most {MAX_URL} of them"
        raise BadInput(message, code="bad_url", where="url")
    return parts


@dataclass(frozen=True)
class Outbound:
    """Calls servers at addresses that are public or in one of these networks."""

    networks: Sequence[Network] = ()
    look_up: Callable[[str, int], Sequence[str]] = look_up

    def addresses(self, url: str) -> list[str]:
        """The addresses that a URL leads to now, each of which may be called.

        Raises:
            BadInput: `bad_url`; `private_address` when one of them may not be called; `insecure_url` without TLS.
            Unreachable: the name is not known.
        """
        parts = parse_url(url)
        host = parts.hostname or ""
        try:
            texts = self.look_up(host, parts.port or _PORTS[parts.scheme])
        except (OSError, UnicodeError):
            raise Unreachable(f"'{host}' cannot be looked up", code="unknown_host", where="url") from None
        if not texts:
            raise Unreachable(f"'{host}' has no address", code="unknown_host", where="url")
        addresses = [ipaddress.ip_address(text.partition("%")[0]) for text in texts]
        listed = [any(address in network for network in self.networks) for address in addresses]
        if not all(known or is_public(address) for known, address in zip(listed, addresses, strict=True)):
            # Which address it is would tell a stranger about the network of this server.
            message = f"'{host}' has an address that is not public, and it is in none of outbound_networks"
            raise BadInput(message, code="private_address", where="url")
        if parts.scheme == "http" and not all(listed):
            message = "only https is called, save in outbound_networks"
            raise BadInput(message, code="insecure_url", where="url")
        return [str(address) for address in addresses]

    @contextmanager
    def call(
        self,
        method: str,
        url: str,
        headers: Mapping[str, str],
        seconds: float,
        content: bytes | None = None,
        silence_s: float | None = None,
    ) -> Iterator[httpcore.Response]:
        """Send a request and give its answer, whose body is read within the block.

        Args:
            seconds: for all of it.
            silence_s: between two pieces of the answer; None = as long as all of it.

        Raises:
            BadInput: the URL may not be called; see `addresses`.
            Unreachable: nobody answered, or the time was over, also within the block.
        """
        until = time.monotonic() + seconds
        backend = _Pinned(self.addresses(url), until)
        # It trusts what httpx trusts: `SSL_CERT_FILE` and `SSL_CERT_DIR` where they are set.
        tls = httpx.create_ssl_context() if url.startswith("https:") else None
        timeouts = {"connect": _CONNECT_S, "read": silence_s or seconds, "write": seconds, "pool": seconds}
        try:
            with (
                httpcore.ConnectionPool(ssl_context=tls, network_backend=backend) as pool,
                pool.stream(
                    method,
                    url,
                    headers=[("Connection", "close"), *headers.items()],
                    content=content,
                    extensions={"timeout": timeouts},
                ) as response,
            ):
                yield response
        except _ERRORS as error:
            host = urlsplit(url).hostname
            said = f"'{host}' does not answer: {type(error).__name__}: {error}".rstrip(": ")
            raise Unreachable(said, where="url") from None


class _Pinned(httpcore.NetworkBackend):
    """Connects to given addresses, whatever the name is; nothing of it lasts beyond a moment."""

    def __init__(self, addresses: Sequence[str], until: float) -> None:
        self._addresses, self._until = addresses, until
        self._backend = httpcore.SyncBackend()

    def connect_tcp(
        self,
        host: str,
        port: int,
        timeout: float | None = None,
        local_address: str | None = None,
        socket_options: Iterable[httpcore.SOCKET_OPTION] | None = None,
    ) -> httpcore.NetworkStream:
        """Connect to the first address that takes the connection."""
        failed: Exception = httpcore.ConnectError("no address")
        for address in self._addresses:
            try:
                stream = self._backend.connect_tcp(
                    address, port, _left(self._until, timeout), local_address, socket_options
                )
                return _Timed(stream, self._until)
            except (httpcore.ConnectError, httpcore.ConnectTimeout) as error:
                failed = error
        raise failed

    def sleep(self, seconds: float) -> None:
        """Wait between attempts, of which there is one."""
        time.sleep(seconds)


class _Timed(httpcore.NetworkStream):
    """A stream on which every step ends at the same moment: bytes that drip in do not make it later."""

    def __init__(self, stream: httpcore.NetworkStream, until: float) -> None:
        self._stream, self._until = stream, until

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:
        """Read what is there."""
        return self._stream.read(max_bytes, _left(self._until, timeout))

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        """Write all of it."""
        self._stream.write(buffer, _left(self._until, timeout))

    def close(self) -> None:
        """Close it."""
        self._stream.close()

    def start_tls(
        self, ssl_context: ssl.SSLContext, server_hostname: str | None = None, timeout: float | None = None
    ) -> httpcore.NetworkStream:
        """Go on encrypted; the certificate must be of the name in the URL."""
        left = _left(self._until, timeout)
        return _Timed(self._stream.start_tls(ssl_context, server_hostname, left), self._until)

    def get_extra_info(self, info: str) -> object:
        """What is known of it."""
        return self._stream.get_extra_info(info)


def _left(until: float, timeout: float | None) -> float:
    left = until - time.monotonic()
    if left <= 0:
        raise httpcore.ReadTimeout("the time for it is over")
    return left if timeout is None else min(left, timeout)
