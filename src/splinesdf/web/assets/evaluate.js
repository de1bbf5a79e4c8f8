// The spline at a point, in float64: what SplineSDF answers in Python.
import { interval } from './tree.js';

// Newton steps onto the zero level set after the first step along the gradient, as in Python.
const CORRECTIONS = 3;

/** Value, first and second derivatives, and the cell; null outside the domain. */
export function evaluate(tree, x, y) {
  const { xs, ys, m, n, child, power: a } = tree;
  if (!(x >= xs[0] && x <= xs[m] && y >= ys[0] && y <= ys[n])) return null;
  const i = interval(xs, x), j = interval(ys, y);
  let width = xs[i + 1] - xs[i], height = ys[j + 1] - ys[j], node = i * n + j;
  let u = (x - xs[i]) / width, v = (y - ys[j]) / height;
  while (child[node] >= 0) {
    u *= 2; v *= 2; width /= 2; height /= 2; node = child[node];
    if (u >= 1) { u -= 1; node += 2; }
    if (v >= 1) { v -= 1; node += 1; }
  }
  const o = 8 * tree.cellOf[node], s = u - 0.5, t = v - 0.5;
  const r = Math.max(s - t, 0), l = Math.max(s + t, 0), right = r > 0 ? 1 : 0, left = l > 0 ? 1 : 0;
  const dr = a[o + 6], dl = a[o + 7];
  return {
    value: a[o] + s * (a[o + 1] + a[o + 3] * s + a[o + 4] * t) + t * (a[o + 2] + a[o + 5] * t) + dr * r * r + dl * l * l,
    gx: (a[o + 1] + 2 * a[o + 3] * s + a[o + 4] * t + 2 * dr * r + 2 * dl * l) / width,
    gy: (a[o + 2] + a[o + 4] * s + 2 * a[o + 5] * t - 2 * dr * r + 2 * dl * l) / height,
    xx: 2 * (a[o + 3] + dr * right + dl * left) / (width * width),
    xy: (a[o + 4] - 2 * dr * right + 2 * dl * left) / (width * height),
    yy: 2 * (a[o + 5] + dr * right + dl * left) / (height * height),
    cell: tree.cellOf[node], level: tree.level[node], width, height,
  };
}

/** The point of the zero level set near a point, or null if a step leaves the domain. */
export function closest(tree, x, y) {
  for (let step = 0; step <= CORRECTIONS; step++) {
    const at = evaluate(tree, x, y), squared = at && at.gx * at.gx + at.gy * at.gy;
    if (!squared) return null;
    x -= at.value / squared * at.gx;
    y -= at.value / squared * at.gy;
  }
  return [x, y];
}

/** Curvature of the level set through a point, positive where the inside is convex. */
export function curvature({ gx, gy, xx, xy, yy }) {
  return (xx * gy * gy - 2 * xy * gx * gy + yy * gx * gx) / Math.hypot(gx, gy) ** 3;
}
