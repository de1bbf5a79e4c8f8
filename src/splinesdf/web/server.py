"""The explorer page from a server of its own: on this machine only, at an address nobody can guess.

browser ─ /TOKEN/ ──────────────→ the page
        ─ /TOKEN/distance?x=&y= → the exact distance
        ─ /TOKEN/offset?d= ─────→ the exact offset, its arcs and its deviation
        ─ /TOKEN/offset.svg?d= ─→ the same as a file, or offset.dxf
"""

from __future__ import annotations

import json
import secrets
import threading
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError, SplineSDFError
from splinesdf.ground.arrays import finite, shown
from splinesdf.splines.spline import SplineSDF
from splinesdf.web.block import check_spline
from splinesdf.web.levels import KINDS, level_at, level_file
from splinesdf.web.page import page_text, policy

# This machine and no other.
_HERE = "127.0.0.1"
# Bytes of chance in the address: other programs of this machine do not guess it.
_TOKEN = 24
_KINDS = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf"}

Answer = tuple[int, str, bytes]


def make_server(spline: SplineSDF) -> tuple[ThreadingHTTPServer, str]:
    """A server of the page, not yet serving, and the address to open.

    Raises
    ------
    InputError
        If the page cannot show the spline, or no port is free.
    """
    check_spline(spline)
    token = secrets.token_urlsafe(_TOKEN)
    page = page_text(spline, [], live=True).encode()
    questions = _Questions(spline)

    def answer(path: str) -> Answer:
        parts = urlsplit(path)
        given, _, question = parts.path.removeprefix("/").partition("/")
        if not secrets.compare_digest(given.encode(), token.encode()):
            return _refused(404, "expected the address that splinesdf view printed, got another")
        if question == "":
            return 200, "text/html; charset=utf-8", page
        return questions.answer(question, parts.query)

    try:
        server = ThreadingHTTPServer((_HERE, 0), _handler(answer))
    except OSError as error:
        raise InputError(f"cannot open a port on {_HERE}: {error.strerror}") from error
    server.daemon_threads = True
    return server, f"http://{_HERE}:{server.server_address[1]}/{token}/"


class _Questions:
    """What the page asks about the shape, one question at a time."""

    def __init__(self, spline: SplineSDF) -> None:
        self._shape = spline.shape
        # One works, the others wait: a slider asks faster than offsets are made.
        self._lock = threading.Lock()
        self._known: dict[str, Callable[[dict[str, float]], Answer]] = {
            "distance": self._distance,
            "offset": self._offset,
        }
        self._known |= {f"offset.{kind}": self._file(kind) for kind in KINDS}

    def answer(self, question: str, query: str) -> Answer:
        if question not in self._known:
            return _refused(404, "expected distance, offset or offset.svg, got another question")
        try:
            with self._lock:
                return self._known[question](_numbers(query))
        except SplineSDFError as error:
            return _refused(400, " ".join(str(error).split()))

    def _distance(self, given: dict[str, float]) -> Answer:
        exact = signed_distance(self._source(), (_one(given, "x"), _one(given, "y")))
        return _json(200, {"distance": float(exact)})

    def _offset(self, given: dict[str, float]) -> Answer:
        level = level_at(self._source(), _one(given, "d"))
        return _json(200, level.figures | {"arcs": level.rows.ravel().tolist()})

    def _file(self, kind: str) -> Callable[[dict[str, float]], Answer]:
        def file(given: dict[str, float]) -> Answer:
            text = level_file(level_at(self._source(), _one(given, "d")), kind)
            if not text:
                raise InputError(f"at {given['d']:g} there is nothing to save")
            return 200, _KINDS[kind], text.encode()

        return file

    def _source(self) -> Any:
        if self._shape is None:
            raise InputError("expected a fit that holds its shape, got another: fit it again")
        return self._shape


def _numbers(query: str) -> dict[str, float]:
    """The numbers of a question."""
    try:
        given = parse_qs(query, max_num_fields=8)
        return {name: finite(float(texts[-1]), "number") for name, texts in given.items()}
    except ValueError as error:
        raise InputError(f"expected a few finite numbers, got {shown(query)}") from error


def _one(given: dict[str, float], name: str) -> float:
    if name not in given:
        raise InputError(f"expected a number {name}, got none")
    return given[name]


def _json(status: int, content: dict[str, Any]) -> Answer:
    return status, "application/json", json.dumps(content, allow_nan=False).encode()


def _refused(status: int, line: str) -> Answer:
    return _json(status, {"error": line})


def _handler(answer: Callable[[str], Answer]) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        """One request."""

        server_version, sys_version = "splinesdf", ""

        def do_GET(self) -> None:
            """Answer it, if it was meant for this machine."""
            host = self.headers.get("Host", "").rpartition(":")[0]
            # A page elsewhere may have its own name point here (DNS rebinding): names are refused.
            if host not in (_HERE, "localhost"):
                status, kind, body = _refused(403, "expected a request to 127.0.0.1, got another")
            else:
                status, kind, body = answer(self.path)
            # The browser gives a question up if the mouse has moved on: nobody waits then.
            with suppress(ConnectionError):
                self._send(status, kind, body)

        def _send(self, status: int, kind: str, body: bytes) -> None:
            self.send_response(status)
            for name, value in (
                ("Content-Type", kind),
                ("Content-Length", str(len(body))),
                ("Content-Security-Policy", f"{policy(live=True)}; frame-ancestors 'none'"),
                ("Referrer-Policy", "no-referrer"),
                ("X-Content-Type-Options", "nosniff"),
                ("Cross-Origin-Resource-Policy", "same-origin"),
                ("Cache-Control", "no-store"),
            ):
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
            """Say nothing: the terminal is the person's."""

    return Handler
