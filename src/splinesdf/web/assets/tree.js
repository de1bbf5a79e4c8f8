// The mesh, and the power form of all cells, as in splinesdf/spaces/quadratic.py.
//
// A grid is a quadtree of which nothing is split, with lines that need not be equidistant.

/** Nodes level after level, their children SW NW SE NE; eight coefficients a cell. */
export function makeTree(head, arrays) {
  const { lines_x: xs, lines_y: ys, split, ordinates } = arrays;
  const m = xs.length - 1, n = ys.length - 1, count = head.nodes, cells = head.cells;
  const tree = {
    xs, ys, m, n, cells, depth: 0, uniform: head.uniform,
    child: new Int32Array(count).fill(-1), cellOf: new Int32Array(count).fill(-1),
    level: new Uint8Array(count), column: new Int32Array(count), row: new Int32Array(count),
    power: new Float64Array(8 * cells),
  };
  const { child, cellOf, level, column, row } = tree;
  for (let i = 0; i < m; i++) for (let j = 0; j < n; j++) { column[i * n + j] = i; row[i * n + j] = j; }
  let next = m * n, cell = 0;
  for (let node = 0; node < count && next <= count; node++) {
    if (split[node >> 3] >> (node & 7) & 1) {
      child[node] = next;
      for (let q = 0; q < 4; q++, next++) {
        level[next] = level[node] + 1;
        column[next] = 2 * column[node] + (q >> 1);
        row[next] = 2 * row[node] + (q & 1);
      }
    } else cellOf[node] = cell++;
  }
  if (next !== count || cell !== cells || ordinates.length !== 8 * cells) {
    throw Error('its cells are not as many as it says');
  }
  tree.depth = level[count - 1];
  powerForm(ordinates, tree.power);
  return tree;
}

/** With s, t the offsets from a cell's center, in cells: q(s, t) + a6 (s - t)₊² + a7 (s + t)₊². */
function powerForm(ordinates, power) {
  for (let o = 0; o < power.length; o += 8) {
    const sw = ordinates[o], se = ordinates[o + 1], nw = ordinates[o + 2], ne = ordinates[o + 3];
    const S = ordinates[o + 4], E = ordinates[o + 5], N = ordinates[o + 6], W = ordinates[o + 7];
    const besideSw = (S + W) / 2, besideNw = (N + W) / 2, C = (S + E + N + W) / 4;
    const pp = C + sw - 2 * besideSw, qq = C + nw - 2 * besideNw;
    const pq = 2 * (C - besideSw - besideNw + W), p = 2 * (besideSw - C), q = 2 * (besideNw - C);
    const s = -(p + q), t = q - p, ss = pp + qq + pq, st = 2 * (pp - qq), tt = pp + qq - pq;
    power[o] = C; power[o + 1] = s; power[o + 2] = t;
    power[o + 3] = ss; power[o + 4] = st; power[o + 5] = tt;
    power[o + 6] = se - (C + (s - t) / 2 + (ss - st + tt) / 4);
    power[o + 7] = ne - (C + (s + t) / 2 + (ss + st + tt) / 4);
  }
}

/** The number of the interval of increasing lines that holds a value; the last one has its end. */
export function interval(lines, value) {
  let low = 0, high = lines.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (lines[middle] <= value) low = middle; else high = middle;
  }
  return low;
}

// 2 to the power of minus a level; powers are dear where each of 100,000 leaves asks for one.
export const HALVED = Float64Array.from({ length: 64 }, (_, level) => 2 ** -level);

/**
 * Where line `i` of a level's lattice is, in pixels from the view's center.
 *
 * Two cells on both sides of a line ask with the same i, or with one a power of two larger, and so
 * get the same number to the last bit: no pixel between them is left out or painted twice.
 */
export function lineAt(lines, center, scale, level, i) {
  const root = i >> level, part = i - (root << level), start = (lines[root] - center) * scale;
  return part === 0 ? start : start + part * ((lines[root + 1] - lines[root]) * scale * HALVED[level]);
}

/** Leaves that meet rows `top` to `bottom` of the picture, or null if there are more than `most`. */
export function visibleLeaves(tree, job, top = 0, bottom = job.height, most = Infinity) {
  const { xs, ys, m, n, child, level, column, row } = tree, { cx, cy, scale, down } = job;
  // One pixel more all around: a leaf too many costs nothing, one too few leaves pixels empty.
  const half = job.width / 2 + 1, ends = [top - job.height / 2 - 1, bottom - job.height / 2 + 1];
  const low = down > 0 ? ends[0] : -ends[1], high = down > 0 ? ends[1] : -ends[0];
  const found = [], stack = [];
  // A node that is seen as a whole goes as ~node: nothing below it need be looked at.
  const look = node => {
    const l = level[node], i = column[node], j = row[node];
    const x0 = lineAt(xs, cx, scale, l, i), x1 = lineAt(xs, cx, scale, l, i + 1);
    const y0 = lineAt(ys, cy, scale, l, j), y1 = lineAt(ys, cy, scale, l, j + 1);
    if (x0 > half || x1 < -half || y0 > high || y1 < low) return;
    stack.push(x0 >= -half && x1 <= half && y0 >= low && y1 <= high ? ~node : node);
  };
  const first = Math.max(0, interval(xs, cx - half / scale) - 1), last = Math.min(m - 1, interval(xs, cx + half / scale) + 1);
  const lowest = Math.max(0, interval(ys, cy + low / scale) - 1), highest = Math.min(n - 1, interval(ys, cy + high / scale) + 1);
  for (let i = first; i <= last; i++) for (let j = lowest; j <= highest; j++) look(i * n + j);
  while (stack.length) {
    const top = stack.pop(), whole = top < 0, node = whole ? ~top : top, next = child[node];
    if (next < 0) {
      found.push(node);
      if (found.length > most) return null;
    } else for (let q = next; q < next + 4; q++) if (whole) stack.push(~q); else look(q);
  }
  return found;
}
