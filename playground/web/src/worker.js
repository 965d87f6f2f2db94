// Instance of the engine in its own thread.

let exports;
/** Message of the last panic. */
let panic = '';
/** Number of ticks between two frames of a watched run. */
let every = 4;
let job = null;

const text = new TextDecoder();
const slice = (at, length) => new Uint8Array(exports.memory.buffer, at, length);

const host = {
  frames(at, length, places, count) {
    const batch = JSON.parse(text.decode(slice(at, length)));
    const numbers = new Float32Array(exports.memory.buffer, places, count).slice();
    postMessage({ job, batch, numbers }, [numbers.buffer]);
    return every;
  },
  panicked(at, length) {
    panic = text.decode(slice(at, length));
  },
};

function call(request) {
  const bytes = new TextEncoder().encode(JSON.stringify(request));
  const at = exports.input(bytes.length);
  slice(at, bytes.length).set(bytes);
  const length = exports.answer();
  return JSON.parse(text.decode(slice(exports.output(), length)));
}

onmessage = async ({ data }) => {
  if (data.module) {
    exports = (await WebAssembly.instantiate(data.module, { host })).exports;
    return;
  }
  job = data.job;
  every = data.request.every ?? 4;
  try {
    postMessage({ job, reply: call(data.request) });
  } catch (error) {
    postMessage({ job, reply: { error: panic || String(error) }, broken: true });
  }
};
