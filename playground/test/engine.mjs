// The engine in Node.js, used as the page's workers use it.
import { readFileSync } from 'node:fs';

/** Returns a function `call(request, frames)` of the engine in a file. */
export async function engine(path) {
  const text = new TextDecoder();
  let exports;
  let panic = '';
  let listener = () => {};
  const slice = (at, length) => new Uint8Array(exports.memory.buffer, at, length);
  const host = {
    frames(at, length, places, count) {
      listener(JSON.parse(text.decode(slice(at, length))), new Float32Array(exports.memory.buffer, places, count));
      return 4;
    },
    panicked(at, length) {
      panic = text.decode(slice(at, length));
    },
  };
  exports = (await WebAssembly.instantiate(await WebAssembly.compile(readFileSync(path)), { host })).exports;
  return (request, frames = () => {}) => {
    listener = frames;
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    slice(exports.input(bytes.length), bytes.length).set(bytes);
    let length;
    try {
      length = exports.answer();
    } catch (error) {
      throw new Error(panic || String(error));
    }
    const reply = text.decode(slice(exports.output(), length));
    const value = JSON.parse(reply);
    if (value.error) throw new Error(value.error);
    return value;
  };
}
