// What part of the plane is seen. Pixels are the device's; `scale` is pixels a unit.

// How far out and in one can go, as shares of the whole domain in the window; and how many units in
// the last place of the largest coordinate a pixel must be wide: fewer, and positions are rounding.
const SMALLEST = 1 / 20, LARGEST = 1e8, ULPS = 4;

export function makeView(tree, yDown) {
  const { xs, ys, m, n } = tree, box = [xs[0], ys[0], xs[m], ys[n]];
  const view = {
    box, down: yDown ? 1 : -1, cx: 0, cy: 0, scale: 1, whole: 1, width: 1, height: 1, ratio: 1,
    free: { left: 0, bottom: 0 },
    finest: 2 ** 52 / ULPS / Math.max(...box.map(Math.abs)),
  };
  return view;
}

/** Take the window's size in, and what of it the panel covers, in pixels of CSS. */
export function resize(view, width, height, ratio, free) {
  const zoom = view.scale / view.whole;
  Object.assign(view, { width, height, ratio, free: { left: free.left * ratio, bottom: free.bottom * ratio } });
  const [xmin, ymin, xmax, ymax] = view.box;
  view.whole = 0.96 * Math.min(
    Math.max(width - view.free.left, 1) / (xmax - xmin), Math.max(height - view.free.bottom, 1) / (ymax - ymin));
  view.scale = bounded(view, zoom * view.whole);
}

/** The whole domain in the free part of the window. */
export function fitWhole(view) {
  const [xmin, ymin, xmax, ymax] = view.box;
  view.scale = view.whole;
  view.cx = (xmin + xmax) / 2 - view.free.left / 2 / view.scale;
  view.cy = (ymin + ymax) / 2 + view.down * view.free.bottom / 2 / view.scale;
}

const bounded = (view, scale) =>
  Math.min(Math.max(scale, view.whole * SMALLEST), view.whole * LARGEST, Math.max(view.finest, view.whole));

export const worldAt = (view, px, py) =>
  [view.cx + (px - view.width / 2) / view.scale, view.cy + view.down * (py - view.height / 2) / view.scale];

export const pixelOf = (view, x, y) =>
  [(x - view.cx) * view.scale + view.width / 2, view.down * (y - view.cy) * view.scale + view.height / 2];

/** Zoom about a pixel, which keeps its place in the plane. */
export function zoomAt(view, factor, px = view.width / 2, py = view.height / 2) {
  const scale = bounded(view, view.scale * factor), shift = 1 / view.scale - 1 / scale;
  view.cx += (px - view.width / 2) * shift;
  view.cy += view.down * (py - view.height / 2) * shift;
  view.scale = scale;
  keepNear(view);
}

export function pan(view, dx, dy) {
  view.cx -= dx / view.scale;
  view.cy -= view.down * dy / view.scale;
  keepNear(view);
}

/** Nobody gets lost: the center of the view stays in the domain's box, grown by half of itself. */
function keepNear(view) {
  const [xmin, ymin, xmax, ymax] = view.box, wide = (xmax - xmin) / 2, high = (ymax - ymin) / 2;
  const far = Math.max(wide, high, view.width / view.scale / 2, view.height / view.scale / 2);
  view.cx = Math.min(Math.max(view.cx, xmin - far), xmax + far);
  view.cy = Math.min(Math.max(view.cy, ymin - far), ymax + far);
}

/** Show a place as a link names it: center, and how many times larger than the whole. */
export function lookAt(view, cx, cy, zoom) {
  view.scale = bounded(view, zoom * view.whole);
  view.cx = cx;
  view.cy = cy;
  keepNear(view);
}

/** 1, 2 or 5 times a power of ten, near a value. */
export function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value)), lead = value / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

/** Digits after the point that a hundredth of a pixel needs; more would be invented. */
export const digits = view => Math.min(15, Math.max(3, Math.ceil(Math.log10(view.scale)) + 2));
