// The colors of both themes, as numbers from 0 to 1, and as the words of an image.

const THEMES = {
  light: {
    inside: [0.62, 0.77, 0.93], outside: [0.97, 0.86, 0.72], line: [0.1, 0.1, 0.1],
    mesh: [0.25, 0.3, 0.45], level: [0.78, 0.1, 0.35], ground: [0.97, 0.97, 0.96],
    exact: '#0a7d33', pen: '#000000',
  },
  dark: {
    inside: [0.13, 0.29, 0.5], outside: [0.38, 0.25, 0.13], line: [0.93, 0.93, 0.93],
    mesh: [0.65, 0.7, 0.85], level: [1, 0.45, 0.6], ground: [0.08, 0.086, 0.1],
    exact: '#7ee787', pen: '#ffffff',
  },
};
// Colors of a fill in each direction: more are not seen; fewer make steps.
const FILLS = 512;

export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

export const theme = () => THEMES[isDark() ? 'dark' : 'light'];

/** A color as a word of an ImageData: bytes R G B A, the first one lowest. */
export const word = ([r, g, b]) => (255 << 24 | Math.round(b * 255) << 16 | Math.round(g * 255) << 8 | Math.round(r * 255)) >>> 0;

/** Fill colors by value, from -range to range: the farther from the boundary the greyer. */
export function fillTable(colors) {
  const table = new Uint32Array(FILLS), middle = FILLS / 2;
  for (let i = 0; i < FILLS; i++) {
    const color = i < middle ? colors.inside : colors.outside;
    const grey = (color[0] + color[1] + color[2]) / 3;
    const share = 0.55 * Math.min(1, Math.abs(i + 0.5 - middle) / middle);
    table[i] = word(color.map(part => part + (grey - part) * share));
  }
  return table;
}

/** Two words mixed: the second with a share from 0 to 1. */
export function mixed(under, over, share) {
  const m = (share * 256) | 0, a = under & 0xff00ff, g = under & 0xff00;
  const rb = a + ((((over & 0xff00ff) - a) * m) >> 8) & 0xff00ff;
  return (0xff000000 | rb | g + ((((over & 0xff00) - g) * m) >> 8) & 0xff00) >>> 0;
}
