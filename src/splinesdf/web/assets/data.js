// The numbers of a page: one deflated block, so that its checksum covers every one of them.
//
//   length of the head | head (JSON) | array | array | ...      each padded to eight bytes

/** The head and the arrays that it names; an Error with one clear line if anything is damaged. */
export async function readBlock(text) {
  let block;
  try {
    block = await inflated(bytesOf(text.trim()));
  } catch {
    throw Error('its numbers do not unpack');
  }
  return unpacked(block);
}

/** The same from the block as it is; workers get it so. */
export function unpacked(block) {
  if (block.byteLength < 8) throw Error('it holds no numbers');
  const length = new DataView(block).getUint32(0, true);
  if (8 + length > block.byteLength) throw Error('its numbers are cut short');
  let head;
  try {
    head = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(new Uint8Array(block, 8, length)));
  } catch {
    throw Error('its description cannot be read');
  }
  if (head.layout !== 1) throw Error('another version of splinesdf made it, with another code');
  const arrays = {};
  let start = padded(8 + length);
  for (const [name, bytes] of head.arrays) {
    if (start + bytes > block.byteLength) throw Error('its numbers are cut short');
    // Texts and flags are bytes, all other arrays float64.
    arrays[name] = head.bytes.includes(name)
      ? new Uint8Array(block, start, bytes) : new Float64Array(block, start, bytes / 8);
    start = padded(start + bytes);
  }
  if (start !== block.byteLength) throw Error('its numbers are not as many as it says');
  return { head, arrays, block };
}

const padded = n => n + (-n & 7);

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}
