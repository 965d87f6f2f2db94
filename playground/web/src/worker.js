// Instance of the engine in its own thread.

let exports;
/** Message of the last panic. */
let panic = '';
/** Number of ticks between two frames of a watched run. */
let every = 4;
let job = null;
/** Records of the runs to summarize, in the order of the runs. */
const kept = [];

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

/** Returns the reply of the engine as text. */
function reply(request) {
  const bytes = new TextEncoder().encode(JSON.stringify(request));
  const at = exports.input(bytes.length);
  slice(at, bytes.length).set(bytes);
  const length = exports.answer();
  return text.decode(slice(exports.output(), length));
}

/**
 * Returns the reply to a request of the page. Complete records stay in workers as text, because the page would take long to
 * receive them.
 */
function answer(request) {
  if (request.call === 'summarize') {
    kept.push(...request.texts.flatMap(text => JSON.parse(text).records));
    kept.sort((a, b) => a.run - b.run);
    return JSON.parse(reply({ ...request, records: kept }));
  }
  const text = reply(request);
  const value = JSON.parse(text);
  if (request.call !== 'simulate' || value.error) return value;
  return { text, records: value.records.map(({ run, outcome, ticks }) => ({ run, outcome, ticks })) };
}

onmessage = async ({ data }) => {
  if (data.module) {
    exports = (await WebAssembly.instantiate(data.module, { host })).exports;
    return;
  }
  job = data.job;
  every = data.request.every ?? 4;
  try {
    postMessage({ job, reply: answer(data.request) });
  } catch (error) {
    postMessage({ job, reply: { error: panic || String(error) }, broken: true });
  }
};
