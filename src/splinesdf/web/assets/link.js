// "Copy what I see": the view, the offset and the switches in the address after its #.

/** What a link holds, as text; numbers with all their digits. */
export function linkText(view, show) {
  const words = [`v=${view.cx},${view.cy},${view.scale / view.whole}`, `o=${show.level}`];
  for (const [name, letter] of FLAGS) words.push(`${letter}=${show[name] ? 1 : 0}`);
  if (document.documentElement.dataset.theme) words.push(`t=${document.documentElement.dataset.theme}`);
  if (show.ruler.length === 2) words.push(`r=${show.ruler.flat()}`);
  return `#${words.join('&')}`;
}

const FLAGS = [['bands', 'c'], ['mesh', 'm'], ['exact', 'e']];

/** The same from an address; whatever is no finite number or no word of ours is passed over. */
export function readLink(hash) {
  const words = new Map(hash.slice(1).split('&').map(word => word.split('=')));
  const numbers = (name, count) => {
    const found = (words.get(name) ?? '').split(',').map(text => (text.trim() ? Number(text) : NaN));
    return found.length === count && found.every(Number.isFinite) ? found : null;
  };
  const result = { view: numbers('v', 3), level: numbers('o', 1)?.[0], ruler: numbers('r', 4) };
  for (const [name, letter] of FLAGS) if (words.has(letter)) result[name] = words.get(letter) === '1';
  if (['dark', 'light'].includes(words.get('t'))) result.theme = words.get('t');
  return result;
}

/** Put a text on the clipboard; whether that was allowed. */
export async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}

/** Hand a file to the person. */
export function download(name, text, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
