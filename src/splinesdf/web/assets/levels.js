// Exact trimmed offsets: those that lie ready in the page, or, with a server, at any distance.
//
// A level: distance, tolerance, deviation (measured), starts of its chains, arcs as rows of seven
// numbers (P0, P1, P2, weight of P1), and its files.

/** Levels of the page, as its head lists them. */
export function readyLevels(head, arrays) {
  return head.levels.map(level => ({
    ...level, arcs: arrays.arcs.subarray(7 * level.first, 7 * (level.first + level.count)),
  }));
}

/** The level that lies nearest to a distance, null if there is none. */
export function nearestLevel(levels, distance) {
  let best = null;
  for (const level of levels) {
    if (!best || Math.abs(level.distance - distance) < Math.abs(best.distance - distance)) best = level;
  }
  return best;
}

/** The text of a ready level's file. */
export function readyFile(arrays, level, kind) {
  const [start, length] = level.files[kind];
  return new TextDecoder().decode(arrays.files.subarray(start, start + length));
}

/** What the server answers to a question, an Error with its line otherwise. */
export async function ask(question, signal) {
  const answer = await fetch(question, { signal, cache: 'no-store' });
  if (answer.ok) return answer;
  let line = `status ${answer.status}`;
  try { line = (await answer.json()).error; } catch { /* the status must do */ }
  throw Error(line);
}

/** The exact offset at a distance, by the server. */
export async function liveLevel(distance, signal) {
  const level = await (await ask(`offset?d=${distance}`, signal)).json();
  return { ...level, arcs: Float64Array.from(level.arcs) };
}

/** How many, and how far off: for the panel. */
export function describe(level) {
  if (level.count === 0) return `exact at ${level.distance}: nothing there as wide as ${short(level.tolerance)}`;
  const arcs = level.count === 1 ? '1 conic' : `${level.count} conics`;
  return `exact at ${level.distance}: ${arcs}, off by ≤ ${short(level.deviation)}`;
}

/** Three digits, rounded up, so that a bound never says too little. */
export function short(value) {
  if (!(value > 0)) return '0';
  const power = Math.floor(Math.log10(value)) - 2, up = Math.ceil(value / 10 ** power - 1e-9) * 10 ** power;
  return power < -5 ? up.toExponential(2) : up.toPrecision(3);
}
