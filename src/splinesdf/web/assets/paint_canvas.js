// The picture by the processor: the spline itself in float64, leaf by leaf into the words of an image.
//
// No search, no texture, no WebGL; exact at every zoom. Runs in the page and in workers alike.
import { HALVED, lineAt, visibleLeaves } from './tree.js';
import { mixed } from './colors.js';

// The slope that a line's width is measured by, at least and at most, as shares of a distance's
// slope 1: on a ridge the gradient vanishes and lines would become as wide as the window; where it
// is steep, as in cells far wider than high, they reach over more of the value than is looked at.
const FLATTEST = 0.25, STEEPEST = 1.25;
// Shares with which lines are mixed in, and half the widths of the strong ones, in pixels of CSS.
const FAINT = 0.45, MESH = 0.6, ZERO = 1.1, LEVEL = 1.3;
// Pixels a cell below which the mesh begins to fade, and below which it is gone.
const FADING = 6, GONE = 3;

/**
 * Paint rows `top` to `bottom` of a picture into `words`, whose first row is `top`.
 *
 * `values`, if given, gets the spline at each pixel's center: tests compare them with Python.
 * One function, all in local variables: most cells have few pixels, and a call for each would take
 * longer than they do.
 */
export function paintRows(tree, job, words, top, bottom, values = null) {
  words.fill(job.ground);
  const { xs, ys, power, level: levels, column, row, cellOf } = tree;
  const { cx, cy, scale, down, width, fills, spacing, level, mesh } = job;
  // Centers of pixels are at whole numbers less these from the view's center.
  const midX = width / 2 - 0.5, midY = job.height / 2 - 0.5, rate = 1 / spacing;
  const reach = STEEPEST * (LEVEL * job.thick + 0.5) / scale;
  const middle = fills.length / 2, fillRate = middle / job.range, most = fills.length - 1;
  for (const node of visibleLeaves(tree, job, top, bottom)) {
    const depth = levels[node], i = column[node], j = row[node];
    const X0 = lineAt(xs, cx, scale, depth, i), X1 = lineAt(xs, cx, scale, depth, i + 1);
    // Which pixels are in the cell is decided by its lines alone.
    const x0 = Math.max(0, Math.ceil(X0 + midX)), x1 = Math.min(width, Math.ceil(X1 + midX));
    if (x0 >= x1) continue;
    const Y0 = lineAt(ys, cy, scale, depth, j), Y1 = lineAt(ys, cy, scale, depth, j + 1);
    const y0 = Math.max(top, Math.ceil((down > 0 ? Y0 : -Y1) + midY));
    const y1 = Math.min(bottom, Math.ceil((down > 0 ? Y1 : -Y0) + midY));
    if (y0 >= y1) continue;
    const rootX = i >> depth, rootY = j >> depth, part = scale * HALVED[depth], o = 8 * cellOf[node];
    const w = (xs[rootX + 1] - xs[rootX]) * part, h = (ys[rootY + 1] - ys[rootY]) * part;
    const a0 = power[o], a1 = power[o + 1], a2 = power[o + 2], a3 = power[o + 3];
    const a4 = power[o + 4], a5 = power[o + 5], a6 = power[o + 6], a7 = power[o + 7], iw = 1 / w, ih = 1 / h;
    const meshShare = mesh ? MESH * Math.min(1, Math.max(0, (Math.min(w, h) - GONE) / (FADING - GONE))) : 0;
    for (let y = y0; y < y1; y++) {
      const t = (down * (y - midY) - Y0) * ih - 0.5, c0 = a0 + t * (a2 + a5 * t), c1 = a1 + a4 * t;
      for (let x = x0, z = (y - top) * width + x0; x < x1; x++, z++) {
        const s = (x - midX - X0) * iw - 0.5, r = s > t ? s - t : 0, l = s > -t ? s + t : 0;
        const v = c0 + s * (c1 + a3 * s) + a6 * r * r + a7 * l * l;
        if (values !== null) values[z] = v;
        const index = v * fillRate + middle;
        let color = fills[index < 0 ? 0 : index > most ? most : index | 0];
        if (meshShare > 0) color = meshed(color, s, t, w, h, job.meshColor, meshShare);
        const f = v * rate + 0.5, band = Math.abs(f - Math.floor(f) - 0.5) * spacing, off = Math.abs(v - level);
        if (off < reach || band < reach) {  // zero is one of the bands
          const gs = (c1 + 2 * (a3 * s + a6 * r + a7 * l)) * iw, gt = (a2 + a4 * s + 2 * (a5 * t - a6 * r + a7 * l)) * ih;
          color = lined(color, v, Math.sqrt(gs * gs + gt * gt), band, off, job);
        }
        words[z] = color;
      }
    }
  }
}

/** A color with a cell's sides and diagonals over it; s, t from its center, w, h its pixels. */
function meshed(color, s, t, w, h, mesh, share) {
  const side = Math.min((0.5 - Math.abs(s)) * w, (0.5 - Math.abs(t)) * h);
  const diagonal = 1.5 * Math.min(Math.abs(s - t), Math.abs(s + t)) * w * h / Math.hypot(w, h);
  const edge = Math.min(side, diagonal);
  return edge < 1.1 ? mixed(color, mesh, share * Math.min(1, 1.1 - edge)) : color;
}

/** A color with level lines over it; `gradient` is a pixel's change of the value v. */
function lined(color, v, gradient, band, off, job) {
  const slope = Math.min(Math.max(gradient, FLATTEST / job.scale), STEEPEST / job.scale);
  const faint = job.bands ? 0.5 + job.thick / 2 - band / slope : 0;
  if (faint > 0) color = mixed(color, job.line, FAINT * Math.min(1, faint));
  const zero = ZERO * job.thick + 0.5 - Math.abs(v) / slope;
  if (zero > 0) color = mixed(color, job.line, zero > 1 ? 1 : zero);
  const near = LEVEL * job.thick + 0.5 - off / slope;
  return near > 0 ? mixed(color, job.levelColor, near > 1 ? 1 : near) : color;
}
