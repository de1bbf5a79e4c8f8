// The page: its state, and what happens when something in it changes.
import { isDark, theme } from './colors.js';
import { listen } from './input.js';
import { ask, describe, liveLevel, nearestLevel, readyFile, readyLevels } from './levels.js';
import { copyText, download, linkText, readLink } from './link.js';
import { drawOverlay } from './overlay.js';
import { makeJob } from './painter.js';
import { makePainters } from './painters.js';
import { element, makePanel } from './panel.js';
import { answerLines, answersAt, boundLine, makeAsker, rulerLines } from './readout.js';
import { digits, fitWhole, lookAt, makeView, pan, pixelOf, resize, worldAt, zoomAt } from './view.js';

// Milliseconds for which the slider rests before the exact offset is asked for, and the window before
// painters are compared; zoom of a key, and of a button.
const REST = 250, SETTLED = 400, BY_KEY = 1.3, BY_BUTTON = 1.5;

/** Start it; returns what tests ask and set. */
export function startPage(content, tree) {
  const { head, arrays } = content;
  const view = makeView(tree, head.y_down), painter = makePainters(element('picture'), element('gl'), content, tree);
  const over = element('over'), pen = over.getContext('2d');
  const ready = readyLevels(head, arrays);
  const show = { level: 0, bands: true, mesh: false, exact: true, ruling: false, ruler: [] };
  let exact = null, hover = null, waiting = false, rest = 0, running = null, segments = 0;

  /** The picture, then what lies over it, lest they are of two views. */
  function paint(inThisThread) {
    const later = painter.paint(makeJob(view, show), inThisThread);
    if (later) return later.then(paintOver);
    paintOver();
  }
  function paintOver() {
    const level = show.exact ? exact : null;
    segments = drawOverlay(pen, view, theme(), { level, hover, ruler: show.ruler });
  }
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; paint(); });
  }

  // ---- the offset: the spline's level at once, the exact one when it rests ----
  function setLevel(value) {
    show.level = value;
    panel.update(show);
    redraw();
    clearTimeout(rest);
    running?.abort();
    if (!show.exact) { exact = null; panel.level(''); return; }
    if (!head.live) {
      exact = nearestLevel(ready, value);
      const note = exact && exact.distance !== value ? ' (the nearest in this file)' : '';
      panel.level(exact ? describe(exact) + note : 'no exact offsets in this file');
    } else {
      if (exact?.distance !== value) { exact = null; panel.level('exact: …'); }
      rest = setTimeout(() => settle(value), exact ? 0 : REST);
    }
  }
  async function settle(value) {
    const mine = running = new AbortController();
    try {
      const found = ready.find(level => level.distance === value) ?? await liveLevel(value, mine.signal);
      if (mine !== running) return;
      exact = found;
      panel.level(describe(found));
    } catch (error) {
      if (error.name === 'AbortError') return;
      panel.level(`no exact offset: ${error.message}`);
    }
    paintOver();
  }
  async function save(kind, type) {
    const level = head.live ? { distance: show.level } : nearestLevel(ready, show.level);
    if (!level) return panel.say('no exact offsets in this file');
    try {
      if (!head.live && !level.files[kind]) throw Error(`at ${level.distance} there is nothing to save`);
      const text = head.live ? await (await ask(`offset.${kind}?d=${level.distance}`)).text() : readyFile(arrays, level, kind);
      download(`${head.file}-offset-${level.distance}.${kind}`, text, type);
      panel.say(`saved the exact offset at ${level.distance}${level.distance === show.level ? '' : ', the nearest in this file'}`);
    } catch (error) {
      panel.say(`not saved: ${error.message}`);
    }
  }

  // ---- what is under the mouse, or in the middle of the view ----
  const askExact = head.live && head.exact ? makeAsker((x, y, found, line) => {
    if (!hover || hover.x !== x || hover.y !== y) return;
    hover.exact = found ? signed(found.distance - hover.value) : line;
    hover.number = found ? found.distance - hover.value : null;
    showAnswers();
  }) : null;
  const signed = value => `${value < 0 ? '−' : '+'}${Math.abs(value).toExponential(3)}`;
  function showAnswers() {
    if (show.ruling) return panel.read(rulerLines(view, show.ruler));
    if (!hover) return panel.read(null);
    panel.read(answerLines(view, hover, hover.exact ?? (askExact ? '…' : boundLine(head))));
  }
  function pointAt(px, py) {
    const [x, y] = worldAt(view, px, py);
    hover = answersAt(tree, x, y);
    if (hover && askExact) askExact(x, y);
    if (hover || show.ruling) showAnswers(); else panel.read([['', 'outside the domain']]);
    paintOver();
  }
  const pointAtMiddle = () => {
    pointAt(view.width / 2, view.height / 2);
    panel.say(hover ? `distance ${hover.value.toFixed(digits(view))}` : 'outside the domain');
  };
  function press(px, py) {
    if (!show.ruling) return;
    show.ruler = [...(show.ruler.length === 2 ? [] : show.ruler), worldAt(view, px, py)];
    showAnswers();
    paintOver();
  }
  function setRuling(on) {
    show.ruling = on;
    show.ruler = [];
    panel.update(show);
    showAnswers();
    paintOver();
  }

  const zoomBy = (factor, px, py) => { zoomAt(view, factor, px, py); redraw(); };
  const setShown = (name, on) => {
    show[name] = on;
    if (name === 'exact') setLevel(show.level); else { panel.update(show); redraw(); }
  };
  const whole = () => { fitWhole(view); redraw(); };
  const act = {
    setLevel, show: setShown, whole,
    in: () => zoomBy(BY_BUTTON), out: () => zoomBy(1 / BY_BUTTON),
    ruler: () => setRuling(!show.ruling),
    theme() {
      document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
      panel.update(show);
      redraw();
    },
    async link() {
      location.hash = linkText(view, show);
      panel.say(await copyText(location.href) ? 'the link is on the clipboard' : 'the link is in the address line');
    },
    svg: () => save('svg', 'image/svg+xml'),
    dxf: () => save('dxf', 'image/vnd.dxf'),
  };
  const panel = makePanel(head, act);
  const toggle = name => () => setShown(name, !show[name]), byKey = factor => () => { zoomBy(factor); pointAtMiddle(); };
  const nudge = sign => () => setLevel(show.level + sign * view.ratio / view.scale);
  listen(over, {
    ratio: () => view.ratio, zoomBy, pointAt, press,
    panBy(dx, dy, byKeys) { pan(view, dx, dy); redraw(); if (byKeys) pointAtMiddle(); },
    leave() { hover = null; showAnswers(); paintOver(); },
    keys: {
      '+': byKey(BY_KEY), '=': byKey(BY_KEY), '-': byKey(1 / BY_KEY), 0: whole, '[': nudge(-1), ']': nudge(1),
      m: toggle('mesh'), c: toggle('bands'), e: toggle('exact'), r: act.ruler, d: act.theme,
      Enter: () => press(view.width / 2, view.height / 2), Escape: () => setRuling(false),
    },
  });

  function measure() {
    const ratio = devicePixelRatio || 1, box = over.parentElement.getBoundingClientRect();
    const width = Math.max(1, Math.round(box.width * ratio)), height = Math.max(1, Math.round(box.height * ratio));
    for (const canvas of [element('picture'), over]) if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const first = view.width === 1, whole = view.scale === view.whole;
    resize(view, width, height, ratio, panel.covers());
    if (first || whole) fitWhole(view);
  }
  function follow(link) {
    if (link.theme) document.documentElement.dataset.theme = link.theme;
    for (const name of ['bands', 'mesh', 'exact']) if (name in link) show[name] = link[name];
    if (link.view) lookAt(view, ...link.view);
    if (link.ruler) { show.ruling = true; show.ruler = [link.ruler.slice(0, 2), link.ruler.slice(2)]; }
    setLevel(link.level ?? show.level);
    showAnswers();
  }
  panel.read(null);
  measure();
  follow(readLink(location.hash));
  // Once the window has its size, WebGL is tried against the processor.
  let settled = 0;
  const compareSoon = () => {
    clearTimeout(settled);
    settled = setTimeout(() => { painter.compare(makeJob(view, show)); redraw(); }, SETTLED);
  };
  addEventListener('resize', () => { measure(); redraw(); compareSoon(); });
  addEventListener('hashchange', () => follow(readLink(location.hash)));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { panel.update(show); redraw(); });
  compareSoon();
  paint(true);  // the first frame at once: workers are not there yet

  return {
    head, painter: () => painter.name, painters: painter.names, use: painter.use, compared: painter.compared,
    state: () => ({ ...view, ...show, exact: exact && exact.distance, segments, hover }),
    async set({ cx = view.cx, cy = view.cy, zoom = view.scale / view.whole, ...shown }) {
      lookAt(view, cx, cy, zoom);
      Object.assign(show, shown);
      setLevel(show.level);
      await paint();
      return { cx: view.cx, cy: view.cy, scale: view.scale, width: view.width, height: view.height, down: view.down };
    },
    values(pixels, name) {
      const found = painter.values(makeJob(view, show), name);
      return pixels.map(([x, y]) => found[y * view.width + x]);
    },
    /** Pixels of the domain that nothing was painted on. */
    uncovered(name) {
      const found = painter.values(makeJob(view, show), name), [xmin, ymin, xmax, ymax] = view.box;
      // Not those on its border: there rounding decides.
      const [x0, ya] = pixelOf(view, xmin, ymin), [x1, yb] = pixelOf(view, xmax, ymax);
      const y0 = Math.min(ya, yb), y1 = Math.max(ya, yb);
      let count = 0;
      for (let y = 0, z = 0; y < view.height; y++) for (let x = 0; x < view.width; x++, z++) {
        const within = x > x0 + 0.5 && x < x1 - 1.5 && y > y0 + 0.5 && y < y1 - 1.5;
        if (within && found[z] !== found[z]) count++;
      }
      return count;
    },
    answers: points => points.map(([x, y]) => answersAt(tree, x, y)),
    pixelOf: (x, y) => pixelOf(view, x, y),
    /** Milliseconds of `count` frames, the view moved by a pixel between them. */
    async times(count) {
      const found = [];
      for (let i = 0; i < count; i++) {
        const start = performance.now();
        view.cx += (i % 2 ? 1 : -1) / view.scale;
        await paint();
        found.push(performance.now() - start);
      }
      return found;
    },
  };
}
