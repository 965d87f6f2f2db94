// Programs and settings in the address. The part after `#` never leaves the browser.

/** Largest size of a program in a link, unpacked [bytes]. */
const MAX = 1 << 20;

async function through(bytes, stream) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const parts = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > MAX) {
      await reader.cancel();
      throw new Error('the program in this link is too large');
    }
    parts.push(value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** Returns the fragment of a link to a state of the page. */
export async function pack(state) {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  const packed = await through(bytes, new CompressionStream('deflate-raw'));
  let text = '';
  for (const byte of packed) text += String.fromCharCode(byte);
  return `#p=${btoa(text).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}`;
}

/** Returns the state in the fragment of a link, or `null` if there is none. Throws an error if the link is damaged. */
export async function unpack(fragment) {
  const packed = /^#p=([\w-]+)$/.exec(fragment)?.[1];
  if (!packed) return null;
  const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), letter => letter.charCodeAt(0));
  const state = JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream('deflate-raw'))));
  if (typeof state?.text !== 'string') throw new Error('the link has no program');
  return state;
}
