// Which painter paints, when, and on what: the picture's canvas.
import { fillTable, theme, word } from './colors.js';
import { paintRows } from './paint_canvas.js';
import { nice } from './view.js';

// Pixels of CSS between two contour lines, about; and the share of the domain's size at which the
// fill has faded.
const BETWEEN = 56, RANGE = 0.25;

/** All that a painter has to know of a frame, as plain numbers: it may be sent to a worker. */
export function makeJob(view, { level, bands, mesh }) {
  const colors = theme(), [xmin, ymin, xmax, ymax] = view.box;
  return {
    cx: view.cx, cy: view.cy, scale: view.scale, down: view.down, width: view.width, height: view.height,
    level, bands, mesh, thick: view.ratio, spacing: nice(BETWEEN * view.ratio / view.scale),
    range: RANGE * Math.max(xmax - xmin, ymax - ymin), fills: fillTable(colors),
    ground: word(colors.ground), line: word(colors.line), meshColor: word(colors.mesh),
    levelColor: word(colors.level), colors,
  };
}

/** Paints frames on a canvas by the processor, in this thread. */
export function canvasPainter(canvas, tree) {
  const pen = canvas.getContext('2d', { alpha: false });
  let image = null;
  return {
    name: 'canvas',
    paint(job) {
      if (!image || image.width !== job.width || image.height !== job.height) {
        image = pen.createImageData(job.width, job.height);
      }
      paintRows(tree, job, new Uint32Array(image.data.buffer), 0, job.height);
      pen.putImageData(image, 0, 0);
    },
    stop() {},
    /** The spline at pixels' centers, by the very loop that paints; NaN where nothing is painted. */
    values(job) {
      const values = new Float64Array(job.width * job.height).fill(NaN);
      paintRows(tree, job, new Uint32Array(values.length), 0, job.height, values);
      return values;
    },
  };
}
