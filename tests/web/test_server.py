"""The local server: its address, its answers, and the page that asks it."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from http.client import HTTPConnection
from urllib.parse import urlsplit

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.web.server import _Questions, make_server
from tests.web.browsing import Shown

Splines = Callable[[str], ss.SplineSDF]


@pytest.fixture(scope="module")
def address(splines: Splines) -> Iterator[str]:
    server, found = make_server(splines("part"))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
    thread.start()
    yield found
    server.shutdown()
    server.server_close()
    thread.join()


def _get(address: str, path: str = "", **headers: str) -> tuple[int, dict[str, str], bytes]:
    parts = urlsplit(address)
    connection = HTTPConnection(parts.hostname or "", parts.port, timeout=60)
    connection.request("GET", path if path.startswith("/") else parts.path + path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, {name.lower(): value for name, value in answer.getheaders()}, body


def test_address_is_local_and_cannot_be_guessed(address: str) -> None:
    parts = urlsplit(address)
    assert parts.hostname == "127.0.0.1"
    assert len(parts.path.strip("/")) >= 32
    status, headers, body = _get(address)
    assert status == 200
    assert b"<canvas" in body
    assert headers["content-security-policy"].startswith("default-src 'none'")
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    for path in ("/", "/x/", f"/{'A' * 32}/distance?x=0&y=0", "/../"):
        status, _, body = _get(address, path)
        assert status == 404
        assert b"canvas" not in body


def test_a_name_that_points_here_is_refused(address: str) -> None:
    port = urlsplit(address).port
    assert _get(address, Host=f"evil.example:{port}")[0] == 403
    assert _get(address, Host=f"localhost:{port}")[0] == 200


def test_answers(address: str, splines: Splines) -> None:
    shape = splines("part").shape
    assert shape is not None
    status, _, body = _get(address, "distance?x=60.25&y=30.5")
    assert status == 200
    assert json.loads(body)["distance"] == ss.signed_distance(shape, (60.25, 30.5))
    status, _, body = _get(address, "offset?d=1.23")
    found = json.loads(body)
    assert status == 200
    assert found["distance"] == 1.23
    rows = np.array(found["arcs"]).reshape(-1, 7)
    assert len(rows) == found["count"]
    assert np.abs(ss.signed_distance(shape, rows[:, :2]) - 1.23).max() <= found["tolerance"]
    assert found["deviation"] <= found["tolerance"]
    assert b"<svg" in _get(address, "offset.svg?d=1.23")[2]
    assert b"SECTION" in _get(address, "offset.dxf?d=1.23")[2]
    assert json.loads(_get(address, "offset?d=-500")[2])["count"] == 0


@pytest.mark.parametrize(
    "question",
    ["distance?x=1", "distance?x=nan&y=0", "offset?d=", "offset?d=1e400", "offset?d=x",
     "offset.svg?d=-500", "offset.exe?d=1", "distance?" + "&".join("abcdefghijkl")],
)  # fmt: skip
def test_bad_questions_are_one_line(question: str, address: str) -> None:
    status, _, body = _get(address, question)
    assert status in (400, 404)
    line = json.loads(body)["error"]
    assert "\n" not in line
    assert "Traceback" not in line
    assert len(line) < 300


def test_a_fit_without_its_shape_is_answered_with_what_is_missing() -> None:
    mesh = Grid.uniform((0.0, 0.0, 1.0, 1.0), 2, 2)
    status, _, body = _Questions(ss.SplineSDF(mesh, np.ones((4, 8)))).answer("offset", "d=0.1")
    assert status == 400
    assert b"expected a fit that holds its shape, got another" in body


def test_a_machine_without_a_free_port_is_told(
    splines: Splines, monkeypatch: pytest.MonkeyPatch
) -> None:
    def taken(*_: object) -> None:
        raise OSError(98, "Address already in use")

    monkeypatch.setattr("splinesdf.web.server.ThreadingHTTPServer", taken)
    with pytest.raises(ss.InputError, match=r"^cannot open a port on 127\.0\.0\.1: Address alr"):
        make_server(splines("part"))


def test_live_page(address: str, splines: Splines, open_page: Callable[..., Shown]) -> None:
    spline = splines("part")
    assert spline.shape is not None
    page = open_page(address, viewport={"width": 1280, "height": 800})
    page.tab.mouse.move(*page.place(60.0, 30.0))
    page.until("typeof splinesdf.state().hover?.number === 'number'")
    hover = page.state()["hover"]
    at = hover["x"], hover["y"]
    exact = float(ss.signed_distance(spline.shape, at)) - float(spline(at))
    assert hover["number"] == pytest.approx(exact, abs=1e-12)
    said = page.read()["exact − spline"].replace("−", "-")
    assert float(said) == pytest.approx(exact, rel=1e-3)
    # The exact offset comes once the slider rests, at its very distance.
    page.tab.fill("#number", "1.37")
    page.until("splinesdf.state().exact === 1.37")
    assert page.text("#found").startswith("exact at 1.37: ")
    with page.tab.expect_download() as waiting:
        page.tab.click("#svg")
    assert waiting.value.suggested_filename == "part-offset-1.37.svg"
    assert page.tab.evaluate("violations") == []
    assert all(one.startswith(address) for one in page.requests)
    assert page.errors == []
