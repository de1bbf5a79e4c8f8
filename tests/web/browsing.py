"""A page in a browser, and what the page's own `window.splinesdf` answers."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_WATCH = """
window.violations = [];
addEventListener('securitypolicyviolation',
  e => window.violations.push(`${e.violatedDirective} ${e.blockedURI}`));
"""


# The words of the picture that is shown.
_PICTURE = """
  const gl = document.getElementById('gl'), c = document.createElement('canvas');
  const shown = gl.hidden ? document.getElementById('picture') : gl;
  c.width = shown.width;
  c.height = shown.height;
  const pen = c.getContext('2d', { willReadFrequently: true });
  pen.drawImage(shown, 0, 0);
  const d = pen.getImageData(0, 0, c.width, c.height).data;"""
_COLORS = f"""() => {{ {_PICTURE}
  let s = '';
  for (let i = 0; i < d.length; i += 8192) s += String.fromCharCode(...d.subarray(i, i + 8192));
  return [btoa(s), c.width, c.height];
}}"""
_DIGEST = f"""() => {{ {_PICTURE}
  let hash = 2166136261;
  for (const word of new Uint32Array(d.buffer)) hash = Math.imul(hash ^ word, 16777619) >>> 0;
  return hash;
}}"""


@dataclass
class Shown:
    """An open page, and what it complained of."""

    tab: Any
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def ask(self, call: str, *arguments: Any) -> Any:
        """What a function of the page's `window.splinesdf` returns."""
        return self.tab.evaluate(f"args => window.splinesdf.{call}(...args)", list(arguments))

    def set(self, **shown: Any) -> dict[str, float]:
        found: dict[str, float] = self.ask("set", shown)
        return found

    def state(self) -> dict[str, Any]:
        found: dict[str, Any] = self.ask("state")
        return found

    def text(self, selector: str) -> str:
        return str(self.tab.inner_text(selector))

    def read(self) -> dict[str, str]:
        """The lines of the read-out."""
        names, texts = (self.tab.locator(f"#read {tag}").all_inner_texts() for tag in ("dt", "dd"))
        return dict(zip(names, texts, strict=True))

    def colors(self) -> NDArray[np.uint8]:
        """The picture as it is on the canvas, (height, width, 3)."""
        text, width, height = self.tab.evaluate(_COLORS)
        found = np.frombuffer(base64.b64decode(text), dtype=np.uint8)
        return found.reshape(height, width, 4)[..., :3]

    def digest(self) -> int:
        """A number that another picture does not have, but by chance."""
        return int(self.tab.evaluate(_DIGEST))

    def until(self, condition: str) -> None:
        """Wait for an expression of JavaScript to become true.

        Not by wait_for_function, which evaluates a text: the page's policy refuses that.
        """
        for _ in range(300):
            if self.tab.evaluate(condition):
                return
            self.tab.wait_for_timeout(50)
        raise AssertionError(f"did not come true: {condition}")

    def points(self, view: dict[str, float], pixels: NDArray[Any]) -> NDArray[np.float64]:
        """Where the centers of pixels (n, 2) are in the plane."""
        x = view["cx"] + (pixels[:, 0] + 0.5 - view["width"] / 2) / view["scale"]
        y = view["cy"] + view["down"] * (pixels[:, 1] + 0.5 - view["height"] / 2) / view["scale"]
        return np.column_stack([x, y])

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where a point is in the window, in pixels of CSS."""
        px, py = self.ask("pixelOf", x, y)
        ratio = self.state()["ratio"]
        return px / ratio, py / ratio


def show(context: Any, address: Path | str) -> Shown:
    """Open a page and wait until it has painted, or has said why it cannot."""
    tab = context.new_page()
    shown = Shown(tab)
    tab.on("pageerror", lambda error: shown.errors.append(str(error)))
    tab.on("request", lambda request: shown.requests.append(request.url))
    tab.add_init_script(_WATCH)
    tab.goto(address.as_uri() if isinstance(address, Path) else address)
    tab.wait_for_selector("html[data-ready], html[data-failed]")
    return shown
