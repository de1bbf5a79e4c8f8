// Visible leaves as numbers that float32 can hold: each leaf's part in view, in float64 expanded
// about its own middle, less the value at the view's center.
//
// Cell-local coordinates alone are not enough: a large leaf's s has 24 bits, and breaks at ×10⁵.
import { HALVED, lineAt } from './tree.js';

// Floats a leaf: the box in pixels, eight coefficients, two diagonals with the part's sides, mesh.
export const ROW = 17;
// Pixels beyond the window that a part reaches; the offset of a diagonal that misses the part.
const BEYOND = 4, AWAY = 9;

/** Fill rows of `out` for leaves. */
export function expandLeaves(tree, job, leaves, base, meshShare, out) {
  const { xs, ys, power, level: levels, column, row, cellOf } = tree, { cx, cy, scale } = job;
  const wide = job.width / 2 + BEYOND, high = job.height / 2 + BEYOND;
  leaves.forEach((node, m) => {
    const depth = levels[node], i = column[node], j = row[node], o = 8 * cellOf[node], z = ROW * m;
    const X0 = lineAt(xs, cx, scale, depth, i), Y0 = lineAt(ys, cy, scale, depth, j);
    const x0 = Math.max(X0, -wide), x1 = Math.min(lineAt(xs, cx, scale, depth, i + 1), wide);
    const y0 = Math.max(Y0, -high), y1 = Math.min(lineAt(ys, cy, scale, depth, j + 1), high);
    const part = scale * HALVED[depth];
    const w = (xs[(i >> depth) + 1] - xs[i >> depth]) * part, h = (ys[(j >> depth) + 1] - ys[j >> depth]) * part;
    // The part's sides and middle in the cell.
    const ks = (x1 - x0) / w, kt = (y1 - y0) / h, s = ((x0 + x1) / 2 - X0) / w - 0.5, t = ((y0 + y1) / 2 - Y0) / h - 0.5;
    const a3 = power[o + 3], a4 = power[o + 4], a5 = power[o + 5], larger = Math.max(ks, kt), reach = (ks + kt) / 2;
    const q = [
      power[o] + s * (power[o + 1] + a3 * s + a4 * t) + t * (power[o + 2] + a5 * t) - base,
      ks * (power[o + 1] + 2 * a3 * s + a4 * t), kt * (power[o + 2] + a4 * s + 2 * a5 * t),
      a3 * ks * ks, a4 * ks * kt, a5 * kt * kt, 0, 0, -AWAY, -AWAY,
    ];
    for (const [k, sign] of [[6, -1], [7, 1]]) {
      const at = s + sign * t, c = power[o + k];
      if (at >= reach) {  // all of the part is on the diagonal's far side: a plain quadratic there
        q[0] += c * at * at; q[1] += 2 * c * at * ks; q[2] += sign * 2 * c * at * kt;
        q[3] += c * ks * ks; q[4] += sign * 2 * c * ks * kt; q[5] += c * kt * kt;
        q[k + 2] = AWAY;
      } else if (at > -reach) {
        q[k] = c * larger * larger;
        q[k + 2] = at / larger;
      }
    }
    // A folded diagonal has no power left: its coefficient is 0.
    out.set([x0, y0, x1, y1, ...q, ks / larger, kt / larger], z);
    out[z + 16] = meshShare * Math.min(1, Math.max(0, (Math.min(w, h) - 3) / 3));
  });
}
