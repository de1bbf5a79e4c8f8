// Painting on several processors: bands of rows, one a worker. Worth it above two million pixels.
//
// A worker runs the page's own code, from a blob; main.js sees that it has no document.
import { unpacked } from './data.js';
import { paintRows } from './paint_canvas.js';
import { makeTree } from './tree.js';

// Workers at most: each has its own copy of the table, 200 bytes a cell with all that belongs to it.
const MOST = 6, MOST_CELLS = 300000;

/** What a worker does: first it gets the block of numbers, then jobs. */
export function serveJobs() {
  let tree = null;
  onmessage = ({ data }) => {
    if (data.block) {
      const { head, arrays } = unpacked(data.block);
      tree = makeTree(head, arrays);
      return;
    }
    const { job, top, bottom, number } = data, count = job.width * (bottom - top);
    const words = data.words && data.words.length === count ? data.words : new Uint32Array(count);
    paintRows(tree, job, words, top, bottom);
    postMessage({ number, top, bottom, words }, [words.buffer]);
  };
}

/** Paints frames by workers on the canvas of a painter; `failed` is called if they cannot. */
export function workersPainter(canvas, block, cells, failed) {
  const pen = canvas.getContext('2d', { alpha: false });
  const wanted = cells > MOST_CELLS ? 2 : Math.min(MOST, Math.max(2, navigator.hardwareConcurrency || 2));
  const address = URL.createObjectURL(new Blob([document.getElementById('code').textContent], { type: 'text/javascript' }));
  const workers = Array.from({ length: wanted }, () => new Worker(address));
  let number = 0, frame = null, next = null;

  workers.forEach((worker, i) => {
    worker.postMessage({ block });
    worker.onerror = failed;
    worker.onmessage = ({ data }) => {
      if (!frame || data.number !== frame.number) return;  // of a frame that was given up
      frame.bands[i] = data;
      if (--frame.missing === 0) finish();
    };
  });
  function finish() {
    const { job, bands, done } = frame;
    for (const { top, bottom, words } of bands) {
      pen.putImageData(new ImageData(new Uint8ClampedArray(words.buffer), job.width, bottom - top), 0, top);
    }
    const spare = bands.map(band => band.words), waiting = next;
    frame = next = null;
    done();
    if (waiting) begin(waiting, spare);
  }
  function begin({ job, done }, spare = []) {
    frame = { number: ++number, job, done, bands: [], missing: workers.length };
    workers.forEach((worker, i) => {
      const top = Math.floor(job.height * i / workers.length), bottom = Math.floor(job.height * (i + 1) / workers.length);
      const words = spare[i];
      worker.postMessage({ job, top, bottom, number, words }, words ? [words.buffer] : []);
    });
  }
  return {
    name: 'workers',
    /** Resolves when the frame, or one asked for later, is on the canvas. */
    paint(job) {
      return new Promise(done => {
        if (!frame) return begin({ job, done });
        // Only the newest of those that wait is painted; all that wait are done with it.
        const before = next;
        next = { job, done() { before?.done(); done(); } };
      });
    },
    stop() { frame = next = null; },
  };
}
