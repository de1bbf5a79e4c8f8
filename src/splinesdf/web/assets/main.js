// Begin: in a worker wait for jobs; in the page unpack the numbers, start the page, and say so if anything is wrong with them.
import { readBlock } from './data.js';
import { makeTree } from './tree.js';
import { startPage } from './page.js';
import { element, fail } from './panel.js';
import { serveJobs } from './workers.js';

async function main() {
  try {
    if (typeof DecompressionStream === 'undefined') {
      return fail('This page needs a browser of 2023 or later: Chrome 80, Firefox 113, Safari 16.4.');
    }
    const content = await readBlock(element('block').textContent);
    const page = startPage(content, makeTree(content.head, content.arrays));
    window.splinesdf = page;  // tests ask it; so may you, in the console
    document.documentElement.dataset.ready = String(performance.now());
  } catch (error) {
    fail(`This page is damaged: ${error.message}. Make it anew by splinesdf view --html.`);
  }
}
if (typeof document === 'undefined') serveJobs(); else main();
