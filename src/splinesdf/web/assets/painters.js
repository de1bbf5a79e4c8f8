// Which painter paints a frame: the processor, several of it above two million pixels, or WebGL2
// where that was found to be quicker.
import { canvasPainter } from './painter.js';
import { glPainter, hasGraphics } from './paint_gl.js';
import { workersPainter } from './workers.js';

// Pixels above which workers paint. More: large windows stutter; fewer: handing bands over takes
// longer than it saves.
const MANY_PIXELS = 2e6;
// Coefficients that float32 holds, with room for sums.
const LARGEST = 1e30;
// Frames of each that are timed; the quickest counts.
const TIMED = 3;

export function makePainters(picture, glCanvas, { head, block }, tree) {
  const canvas = canvasPainter(picture, tree);
  let workers = null, broken = typeof Worker === 'undefined', forced = null, last = canvas;
  let gl = null, quicker = false, compared = false, refused = !tree.power.every(part => Math.abs(part) < LARGEST);

  function byWorkers() {
    if (broken) return null;
    try {
      workers ??= workersPainter(picture, block, head.cells, () => { broken = true; workers?.stop(); });
    } catch {
      broken = true;
    }
    return broken ? null : workers;
  }
  function byGl() {
    if (refused) return null;
    gl ??= glPainter(glCanvas, tree);
    if (!gl) refused = true;
    return gl && gl.usable() ? gl : null;
  }
  function choose(job) {
    if (forced === 'quads' || forced === 'walk') return byGl() ?? canvas;
    if (forced) return forced === 'workers' ? byWorkers() ?? canvas : canvas;
    if (quicker && gl.usable()) return gl;
    return job.width * job.height > MANY_PIXELS ? byWorkers() ?? canvas : canvas;
  }
  function byProcessor(painter, job) {
    glCanvas.hidden = true;
    return painter.paint(job);
  }
  return {
    get name() { return last.name; },
    names: () => ['canvas', ...(broken ? [] : ['workers']), ...(byGl() ? ['quads', ...(tree.uniform ? ['walk'] : [])] : [])],
    /** Paint; if that takes other threads, a promise of it. */
    paint(job, inThisThread = false) {
      const painter = inThisThread ? canvas : choose(job);
      if (painter !== last) last.stop();
      last = painter;
      if (painter !== gl) return byProcessor(painter, job);
      try {
        gl.paint(job, forced);
        glCanvas.hidden = false;
      } catch (error) {  // a driver that cannot: never again
        console.warn(`WebGL is not used: ${error.message}`);
        refused = true;
        quicker = false;
        forced = null;
        last = canvas;
        return byProcessor(canvas, job);
      }
    },
    /** Find out whether WebGL is quicker; not tried where it is software. */
    compare(job) {
      compared = true;
      if (refused || forced || !hasGraphics() || !byGl()) return;
      try {
        gl.paint(job);  // compiles
        const times = [gl, canvas].map(painter => {
          const each = Array.from({ length: TIMED }, () => {
            const start = performance.now();
            painter.paint(job);
            return performance.now() - start;
          });
          return Math.min(...each);
        });
        quicker = times[0] < times[1];
      } catch {
        refused = true;
        quicker = false;
      }
    },
    compared: () => compared,
    /** Use this painter alone; null: choose again. */
    use(name) { forced = name; },
    values: (job, name) => (name ? byGl().values(job, name) : canvas.values(job)),
  };
}
