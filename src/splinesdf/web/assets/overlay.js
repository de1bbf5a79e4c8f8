// What is drawn over the picture: conics of the exact offset, the hovered point, the ruler.
import { pixelOf } from './view.js';

// Pixels by which a conic's chord may miss it; halvings after which it is drawn as its chord.
const FLAT = 0.15, HALVINGS = 40;
// Coordinates, in pixels, that canvases draw rightly.
const FAR = 3e4;

export function drawOverlay(pen, view, colors, { level, hover, ruler }) {
  const { width, height, ratio } = view;
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, width, height);
  let segments = 0;
  if (level) segments = drawLevel(pen, view, colors, level);
  if (hover) drawHover(pen, view, colors, hover);
  if (ruler.length) drawRuler(pen, view, colors, ruler);
  pen.lineWidth = ratio;
  return segments;
}

function drawLevel(pen, view, colors, { arcs }) {
  const path = { pen, halfX: view.width / 2, halfY: view.height / 2, segments: 0 };
  pen.beginPath();
  for (let o = 0; o < arcs.length; o += 7) {
    const xy = [];
    for (let q = 0; q < 6; q += 2) {
      xy.push((arcs[o + q] - view.cx) * view.scale, view.down * (arcs[o + q + 1] - view.cy) * view.scale);
    }
    // A chain goes on where its last arc ended, so that dashes do not begin anew.
    const goesOn = o > 0 && arcs[o] === arcs[o - 3] && arcs[o + 1] === arcs[o - 2];
    if (!goesOn) move(path, xy[0], xy[1]);
    conic(path, ...xy, arcs[o + 6], 0);
  }
  pen.strokeStyle = colors.exact;
  pen.lineWidth = 2 * view.ratio;
  pen.setLineDash([7 * view.ratio, 4 * view.ratio]);
  pen.stroke();
  pen.setLineDash([]);
  return path.segments;
}

const near = (value, half) => Math.max(-FAR, Math.min(FAR, value + half));
const move = (path, x, y) => path.pen.moveTo(near(x, path.halfX), near(y, path.halfY));

/** An arc, halved in float64 about the view's center; what its control triangle keeps out is left. */
function conic(path, x0, y0, x1, y1, x2, y2, w, depth) {
  const { halfX, halfY } = path;
  if (Math.min(x0, x1, x2) > halfX || Math.max(x0, x1, x2) < -halfX
    || Math.min(y0, y1, y2) > halfY || Math.max(y0, y1, y2) < -halfY) return move(path, x2, y2);
  const rest = 2 + 2 * w, mx = (x0 + 2 * w * x1 + x2) / rest, my = (y0 + 2 * w * y1 + y2) / rest;
  const sag = Math.hypot(mx - (x0 + x2) / 2, my - (y0 + y2) / 2), long = Math.max(Math.abs(x2 - x0), Math.abs(y2 - y0));
  if (depth > HALVINGS || (sag < FLAT && long < FAR / 2)) {
    path.segments++;
    return path.pen.lineTo(near(x2, halfX), near(y2, halfY));
  }
  const v = Math.sqrt((1 + w) / 2), q = 1 / (1 + w);
  conic(path, x0, y0, (x0 + w * x1) * q, (y0 + w * y1) * q, mx, my, v, depth + 1);
  conic(path, mx, my, (w * x1 + x2) * q, (w * y1 + y2) * q, x2, y2, v, depth + 1);
}

function drawHover(pen, view, colors, { x, y, foot, value }) {
  const [px, py] = pixelOf(view, x, y), dot = 4 * view.ratio;
  pen.strokeStyle = pen.fillStyle = colors.pen;
  pen.lineWidth = view.ratio;
  // The circle of the distance about the point: it touches the curve where that is closest.
  const radius = Math.abs(value) * view.scale;
  if (radius < FAR) {
    pen.globalAlpha = 0.45;
    pen.beginPath();
    pen.arc(px, py, radius, 0, 2 * Math.PI);
    pen.stroke();
    pen.globalAlpha = 1;
  }
  pen.beginPath();
  pen.moveTo(px - dot, py); pen.lineTo(px + dot, py); pen.moveTo(px, py - dot); pen.lineTo(px, py + dot);
  pen.stroke();
  if (!foot) return;
  const [fx, fy] = pixelOf(view, ...foot);
  if (Math.abs(fx) > FAR || Math.abs(fy) > FAR) return;
  pen.beginPath();
  pen.moveTo(px, py); pen.lineTo(fx, fy);
  pen.stroke();
  pen.beginPath();
  pen.arc(fx, fy, dot, 0, 2 * Math.PI);
  pen.fill();
}

function drawRuler(pen, view, colors, ruler) {
  const at = ruler.map(([x, y]) => pixelOf(view, x, y).map(value => near(value, 0)));
  pen.strokeStyle = pen.fillStyle = colors.pen;
  pen.lineWidth = 2 * view.ratio;
  pen.beginPath();
  at.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
  for (const [x, y] of at) pen.fillRect(x - 4 * view.ratio, y - 4 * view.ratio, 8 * view.ratio, 8 * view.ratio);
}
