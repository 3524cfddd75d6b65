"""Addresses to listen at, and the values of Host and Origin with which clients show that they mean this server."""

from __future__ import annotations

import ipaddress
import re
import socket
from collections.abc import Iterable, Sequence
from typing import NamedTuple

__all__ = ["Address", "HttpRefused", "address", "allowed_hosts", "anywhere", "host_of", "why_refused"]

_LOOPBACK = ("127.0.0.1", "localhost", "::1")
_LABELS = r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)*\.?"
_ZONE = r"%(?:25)?[A-Za-z0-9._~-]+"
"""The end of an address that is valid on one network only; clients send it or leave it out."""
_AUTHORITY = re.compile(rf"(\[[0-9A-Fa-f:.]+(?:{_ZONE})?\]|{_LABELS})(?::[0-9]{{1,5}})?")
_ORIGIN = re.compile(rf"https?://({_AUTHORITY.pattern})", re.IGNORECASE)
_NUMBERS = re.compile(r"[0-9][0-9a-fx.]*")
_NUMBER_LAST = re.compile(r"(.*\.)?([0-9]+|0x[0-9a-f]*)")
"""The look that only an address may have."""


class HttpRefused(ValueError):
    """Options with which serving would be unsafe or impossible."""


class Address(NamedTuple):
    """Host, in its one spelling (see :func:`host_of`), and port to listen at."""

    host: str
    port: int

    @property
    def loopback(self) -> bool:
        """Whether only this machine can connect."""
        known = _parsed(self.host)
        return self.host == "localhost" or (known is not None and known.is_loopback)

    @property
    def name(self) -> str:
        """The host as it appears in a URL."""
        return f"[{self.host}]" if ":" in self.host else self.host


def address(text: str) -> Address:
    """Read ``[HOST:]PORT``; without a host it is 127.0.0.1.

    Args:
        text: Text such as ``8000``, ``127.0.0.1:8000`` or ``[::1]:8000``; port 0 chooses a free port.
    """
    host, _, port = text.rpartition(":")
    if ":" in host and not (host.startswith("[") and host.endswith("]")):
        raise ValueError(f"{text} is not [HOST:]PORT; write IPv6 addresses as [::1]:8000")
    host = host.removeprefix("[").removesuffix("]")
    if not re.fullmatch(r"[0-9]{1,5}", port) or int(port) > 65535 or (":" in text and not host):
        raise ValueError(f"{text} is not [HOST:]PORT")
    return Address(host_of(host) if host else "127.0.0.1", int(port))


def host_of(text: str) -> str:
    """The one spelling of a host: lower case, and the usual form of an address.

    ``0`` is 0.0.0.0, ``127.1`` is 127.0.0.1, and ``::ffff:1.2.3.4``, which reaches the same clients, is 1.2.3.4.
    """
    host = text.lower().removeprefix("[").removesuffix("]").removesuffix(".")
    known = _parsed(host)
    if known is None:
        if not _NUMBERS.fullmatch(host):
            return host
        try:
            return socket.inet_ntoa(socket.inet_aton(host))  # spellings that the operating system accepts: 0, 127.1
        except OSError:
            return host
    mapped = known.ipv4_mapped if isinstance(known, ipaddress.IPv6Address) else None
    return str(mapped or known)


def anywhere(where: Address) -> bool:
    """Whether a server listens at every address of this machine, also if that address is given by a name."""
    try:
        matches = [str(one[4][0]) for one in socket.getaddrinfo(where.host, where.port, type=socket.SOCK_STREAM)]
    except (OSError, UnicodeError):  # binding will say why
        matches = []
    return any(_unspecified(host_of(host)) for host in (where.host, *matches))


def _unspecified(host: str) -> bool:
    known = _parsed(host)
    return known is not None and known.is_unspecified


def allowed_hosts(where: Address, names: Sequence[str]) -> frozenset[str]:
    """The hosts that requests may name.

    Args:
        where: Host and port of the server.
        names: Names and addresses of ``--allow-host``, with or without a port.

    Raises:
        HttpRefused: A name is not a host name.
    """
    more = []
    for name in names:
        match = _AUTHORITY.fullmatch(name) or _AUTHORITY.fullmatch(f"[{name}]")
        host = _named(match)
        if not host or _unspecified(host) or (_NUMBER_LAST.fullmatch(host) and _parsed(host) is None):
            raise HttpRefused(f"--allow-host {name!r}: give a name or an address that clients connect to")
        more.append(host)
    own = _LOOPBACK if where.loopback else ()
    return frozenset((*own, where.host.partition("%")[0], *more)) - {""}


def _named(match: re.Match[str] | None, group: int = 1) -> str:
    """The host that a matched text names, without its zone; empty if it names none."""
    host = "" if match is None else host_of(re.sub(_ZONE, "", match[group]))
    return "" if match is not None and match[group].startswith("[") and _parsed(host) is None else host


def _parsed(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """The address that a host is; None for a name."""
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None


def why_refused(headers: Iterable[tuple[bytes, bytes]], allowed: frozenset[str]) -> tuple[int, str] | None:
    """Why a request is not from a client of this server: status and text; None if it is.

    Pages of other sites are kept out: they send their own Origin, or a Host that was made to lead here.

    Args:
        headers: Names, in lower case, and values of the headers.
        allowed: The hosts that may be named.
    """
    hosts, origins = ([v.decode("latin-1") for n, v in headers if n == name] for name in (b"host", b"origin"))
    if len(hosts) > 1:
        return 400, "Several Host headers"
    if _named(_AUTHORITY.fullmatch(hosts[0]) if hosts else None) not in allowed:
        return 421, "Invalid Host header"
    if not origins:
        return None
    if _named(_ORIGIN.fullmatch(origins[0]) if len(origins) == 1 else None, 2) not in allowed:
        return 403, "Invalid Origin header"
    return None
