// The panel: its elements, what they show and what pressing them does.
import { isDark } from './colors.js';
import { HINT } from './readout.js';
import { short } from './levels.js';

export const element = id => document.getElementById(id);

/** Wire the panel up. `act` has a function for each thing that a person can do in it. */
export function makePanel(head, act) {
  const slider = element('level'), number = element('number');
  [slider.min, slider.max] = head.range;
  for (const input of [slider, number]) input.addEventListener('input', () => {
    // An empty field is no zero, and a half-typed number no number.
    if (input.value.trim() && Number.isFinite(Number(input.value))) act.setLevel(Number(input.value));
  });
  for (const name of ['bands', 'mesh', 'exact']) {
    element(name).addEventListener('change', event => act.show(name, event.target.checked));
  }
  for (const name of ['in', 'out', 'whole', 'ruler', 'theme', 'link', 'svg', 'dxf']) {
    element(name).addEventListener('click', () => act[name]());
  }
  if (!head.dxf) {
    element('dxf').disabled = true;
    element('dxf').title = 'made without ezdxf: pip install "splinesdf[dxf]"';
  }
  element('facts').textContent = facts(head);
  return {
    /** Show what is set, wherever it was set. */
    update(show) {
      if (document.activeElement !== number || Number(number.value) !== show.level) {
        number.value = Number(show.level.toPrecision(9));
      }
      slider.value = show.level;
      for (const name of ['bands', 'mesh', 'exact']) element(name).checked = show[name];
      element('ruler').setAttribute('aria-pressed', show.ruling);
      element('theme').textContent = isDark() ? 'Light' : 'Dark';
    },
    level: text => put('found', text),
    say: text => put('status', text),
    read: lines => showLines(element('read'), lines),
    /** What of the window the panel covers: to the left of the picture, or below it. */
    covers() {
      const box = element('panel').getBoundingClientRect();
      const beside = box.right < innerWidth - 1;
      return { left: beside ? box.right : 0, bottom: beside ? 0 : box.height };
    },
  };
}

function put(id, text) {
  if (element(id).textContent !== text) element(id).textContent = text;
}

function facts({ cells, bound, error, bands, version }) {
  const where = bands ? ' in the band' : '';
  const off = bound !== null ? `, |error| ≤ ${short(bound)}${where} (proved)`
    : error !== null ? `, |error| about ${short(error)}${where} (sampled)` : '';
  return `${cells.toLocaleString('en')} cells${off}; splinesdf ${version}`;
}

/** Pairs of a name and a text as a definition list; its nodes are made once and used again. */
function showLines(list, lines) {
  if (!lines) lines = [['', HINT]];
  while (list.children.length > 2 * lines.length) list.lastChild.remove();
  while (list.children.length < 2 * lines.length) list.append(document.createElement('dt'), document.createElement('dd'));
  lines.forEach(([name, text], i) => {
    list.children[2 * i].textContent = name;
    list.children[2 * i + 1].textContent = text;
  });
}

/** One line instead of the page: what is wrong with it. */
export function fail(message) {
  element('fail').hidden = false;
  element('fail').textContent = message;
  element('panel').hidden = true;
  document.documentElement.dataset.failed = '1';
}
