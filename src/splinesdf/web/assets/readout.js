// The numbers at a point: distance, normal, closest point, curvature, exact − spline.
import { closest, curvature, evaluate } from './evaluate.js';
import { ask, short } from './levels.js';
import { digits } from './view.js';

// Milliseconds for which the mouse rests before the server is asked.
const REST = 150;
export const HINT = 'Point at the picture: distance, normal, closest point, curvature.';

/** The spline's answers at a point; null outside the domain. */
export function answersAt(tree, x, y) {
  const at = evaluate(tree, x, y);
  if (!at) return null;
  const length = Math.hypot(at.gx, at.gy);
  return {
    x, y, ...at, foot: closest(tree, x, y), curvature: curvature(at),
    normal: length > 0 ? [at.gx / length, at.gy / length] : null,
  };
}

/** As lines of text; `exact` is the line about the exact distance. */
export function answerLines(view, found, exact) {
  const n = digits(view), fixed = value => value.toFixed(n), pair = at => `${fixed(at[0])}, ${fixed(at[1])}`;
  return [
    ['distance', fixed(found.value)],
    ['exact − spline', exact],
    ['at', pair([found.x, found.y])],
    ['normal', found.normal ? found.normal.map(part => part.toFixed(6)).join(', ') : 'none: the gradient is 0'],
    ['closest', found.foot ? pair(found.foot) : 'beyond the domain'],
    ['curvature', Number.isFinite(found.curvature) ? found.curvature.toPrecision(5) : 'none'],
    ['cell', `${found.cell}, level ${found.level}, ×${(view.scale / view.whole).toPrecision(3)}`],
  ];
}

/** What a page without a server says instead of a number. */
export function boundLine({ bound, error, bands }) {
  const where = bands ? ' in the band' : '';
  if (bound !== null) return `within ±${short(bound)}${where} (proved)`;
  return error === null ? 'not known' : `within ±${short(error)}${where} (sampled)`;
}

/** Asks the server for the exact distance once the mouse rests; the newest question alone counts. */
export function makeAsker(answer) {
  let timer = 0, running = null;
  return (x, y) => {
    clearTimeout(timer);
    running?.abort();
    timer = setTimeout(async () => {
      const mine = running = new AbortController();
      try {
        answer(x, y, await (await ask(`distance?x=${x}&y=${y}`, mine.signal)).json(), '');
      } catch (error) {
        if (error.name !== 'AbortError') answer(x, y, null, error.message);
      }
    }, REST);
  };
}

export function rulerLines(view, [a, b]) {
  const fixed = value => value.toFixed(digits(view));
  if (!a) return [['ruler', 'press at the first point']];
  if (!b) return [['ruler', 'press at the second point'], ['from', `${fixed(a[0])}, ${fixed(a[1])}`]];
  const dx = b[0] - a[0], dy = b[1] - a[1];
  return [
    ['length', fixed(Math.hypot(dx, dy))],
    ['dx, dy', `${fixed(dx)}, ${fixed(dy)}`],
    // As seen: counterclockwise on the screen, whichever way y points.
    ['angle', `${(Math.atan2(-view.down * dy, dx) * 180 / Math.PI).toFixed(4)}°`],
    ['from', `${fixed(a[0])}, ${fixed(a[1])}`],
    ['to', `${fixed(b[0])}, ${fixed(b[1])}`],
  ];
}
