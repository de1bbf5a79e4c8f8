// The picture by the processor: the spline itself in float64, leaf by leaf into the words of an image.
//
// No search, no texture, no WebGL; exact at every zoom. Runs in the page and in workers alike.
import { lineAt, visibleLeaves } from './tree.js';
import { mixed } from './colors.js';

// Pixels from a line within which the gradient is needed: half the thickest line, and smoothing.
const REACH = 2.2;
// The slope that a line's width is measured by, at least, as a share of a distance's slope 1: on a
// ridge the gradient vanishes and lines would become as wide as the window.
const FLATTEST = 0.25;
// Shares with which lines are mixed in, and half the widths of the strong ones, in pixels.
const FAINT = 0.35, MESH = 0.6, ZERO = 1.1, LEVEL = 1.3;
// Pixels a cell below which the mesh begins to fade, and below which it is gone.
const FADING = 6, GONE = 3;

/**
 * Paint rows `top` to `bottom` of a picture into `words`, whose first row is `top`.
 *
 * `values`, if given, gets the spline at each pixel's center: tests compare them with Python.
 */
export function paintRows(tree, job, words, top, bottom, values = null) {
  words.fill(job.ground);
  for (const node of visibleLeaves(tree, job, top, bottom)) paintLeaf(tree, job, node, words, top, bottom, values);
}

function paintLeaf(tree, job, node, words, top, bottom, values) {
  const { xs, ys, power } = tree, { cx, cy, scale, down, width, spacing } = job;
  const depth = tree.level[node], i = tree.column[node], j = tree.row[node];
  const X0 = lineAt(xs, cx, scale, depth, i), X1 = lineAt(xs, cx, scale, depth, i + 1);
  const Y0 = lineAt(ys, cy, scale, depth, j), Y1 = lineAt(ys, cy, scale, depth, j + 1);
  // Centers of pixels from the view's center; which are in the cell is decided by its lines alone.
  const midX = width / 2 - 0.5, midY = job.height / 2 - 0.5;
  const high = down > 0 ? Y0 : -Y1, low = down > 0 ? Y1 : -Y0;
  const x0 = Math.max(0, Math.ceil(X0 + midX)), x1 = Math.min(width, Math.ceil(X1 + midX));
  const y0 = Math.max(top, Math.ceil(high + midY)), y1 = Math.min(bottom, Math.ceil(low + midY));
  if (x0 >= x1 || y0 >= y1) return;
  const root = i >> depth, rootY = j >> depth, part = scale / 2 ** depth;
  const w = (xs[root + 1] - xs[root]) * part, h = (ys[rootY + 1] - ys[rootY]) * part;
  const o = 8 * tree.cellOf[node];
  const a0 = power[o], a1 = power[o + 1], a2 = power[o + 2], a3 = power[o + 3];
  const a4 = power[o + 4], a5 = power[o + 5], a6 = power[o + 6], a7 = power[o + 7];
  const iw = 1 / w, ih = 1 / h, flattest = FLATTEST / scale, reach = REACH / scale, rate = 1 / spacing;
  const { fills, bands, line, level, levelColor } = job, middle = fills.length / 2;
  const fillRate = middle / job.range, most = fills.length - 1;
  const faded = Math.min(1, Math.max(0, (Math.min(w, h) - GONE) / (FADING - GONE)));
  const meshShare = job.mesh ? MESH * faded : 0, mesh = job.meshColor, diagonal = 1 / Math.hypot(iw, ih);
  for (let y = y0; y < y1; y++) {
    const t = (down * (y - midY) - Y0) * ih - 0.5, c0 = a0 + t * (a2 + a5 * t), c1 = a1 + a4 * t;
    for (let x = x0, z = (y - top) * width + x0; x < x1; x++, z++) {
      const s = (x - midX - X0) * iw - 0.5, r = s > t ? s - t : 0, l = s > -t ? s + t : 0;
      const v = c0 + s * (c1 + a3 * s) + a6 * r * r + a7 * l * l;
      if (values) values[z] = v;
      const index = v * fillRate + middle;
      let color = fills[index < 0 ? 0 : index > most ? most : index | 0];
      if (meshShare > 0) {
        const side = Math.min((0.5 - Math.abs(s)) * w, (0.5 - Math.abs(t)) * h);
        const edge = Math.min(side, 1.5 * Math.min(Math.abs(s - t), Math.abs(s + t)) * diagonal);
        if (edge < 1.1) color = mixed(color, mesh, meshShare * Math.min(1, 1.1 - edge));
      }
      const f = v * rate + 0.5, band = Math.abs(f - Math.floor(f) - 0.5) * spacing, off = Math.abs(v - level);
      if (off < reach || band < reach) {  // zero is one of the bands
        const gs = (c1 + 2 * (a3 * s + a6 * r + a7 * l)) * iw, gt = (a2 + a4 * s + 2 * (a5 * t - a6 * r + a7 * l)) * ih;
        const slope = Math.max(Math.sqrt(gs * gs + gt * gt), flattest);
        const faint = bands ? 1 - band / slope : 0;
        if (faint > 0) color = mixed(color, line, FAINT * faint);
        const zero = ZERO + 0.5 - Math.abs(v) / slope;
        if (zero > 0) color = mixed(color, line, zero > 1 ? 1 : zero);
        const near = LEVEL + 0.5 - off / slope;
        if (near > 0) color = mixed(color, levelColor, near > 1 ? 1 : near);
      }
      words[z] = color;
    }
  }
}
