// Reader of the recording. docs/guides/replay.md describes the format.

const VERSION = 1;
/** Size of the checksum after every part [bytes]. */
const SEAL = 4;
/** Largest size of the unpacked positions in memory [bytes]. */
const CACHE = 96 << 20;

/** Reader for parts of a long base64 text. Does not decode the whole text. */
class Base64 {
  constructor(text) {
    this.text = text;
    const padding = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
    this.length = Math.floor(text.length / 4) * 3 - padding;
  }

  /** Returns the bytes from `from` up to `to`, exclusive. */
  bytes(from, to) {
    if (to > this.length) throw new Unreadable(CUT_SHORT);
    const first = Math.floor(from / 3);
    const text = atob(this.text.slice(first * 4, Math.ceil(to / 3) * 4));
    const skip = from - first * 3;
    const bytes = new Uint8Array(to - from);
    for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i + skip);
    return bytes;
  }
}

const CUT_SHORT = 'The recording in this page is incomplete. Write the page again with `stochc replay`.';

async function inflate(bytes) {
  if (typeof DecompressionStream === 'undefined') {
    throw new Unreadable('This browser is too old to unpack the recording: it has no DecompressionStream.');
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Unreadable('The recording in this page is damaged. Make the page again with `stochc replay`.');
  }
}

class Recording {
  /** Reads the whole recording except the positions, which are unpacked when they are needed. */
  static async open(text) {
    const recording = new Recording();
    const data = (recording.data = new Base64(text));
    if (new TextDecoder().decode(data.bytes(0, 8)) !== 'STOCHREC') {
      throw new Unreadable('There is no recording in this page.');
    }
    const number = at => new DataView(data.bytes(at, at + 4).buffer).getUint32(0, true);
    const version = number(8);
    if (version !== VERSION) {
      throw new Unreadable(
        `The recording in this page is of format version ${version}, and the page can show version ${VERSION}. ` +
          'Make the page again with the `stochc` that recorded the run.',
      );
    }
    let at = 16 + number(12);
    recording.header = JSON.parse(new TextDecoder().decode(data.bytes(16, at)));
    at += SEAL;
    recording.chunks = [];
    recording.events = [];
    while (!recording.record) {
      const tag = new TextDecoder().decode(data.bytes(at, at + 4));
      const from = at + 8;
      const to = (at = from + number(at + 4));
      at += SEAL;
      if (at > data.length) throw new Unreadable(CUT_SHORT);
      const json = async () => JSON.parse(new TextDecoder().decode(await inflate(data.bytes(from, to))));
      if (tag === 'POSE') recording.chunks.push(chunkHead(data, from, to));
      else if (tag === 'EVNT') for (const row of await json()) recording.events.push(row);
      else if (tag === 'DONE') recording.record = await json();
      else throw new Unreadable('The recording in this page is damaged: it has a part of an unknown kind.');
    }
    recording.bodies = recording.header.bodies;
    // Frame f of the whole recording is frame f - begins[c] of chunk c.
    recording.begins = [];
    recording.ticks = [];
    for (const chunk of recording.chunks) {
      recording.begins.push(recording.ticks.length);
      for (const tick of chunk.ticks) recording.ticks.push(tick);
    }
    recording.cache = new Map();
    recording.cached = 0;
    return recording;
  }

  /** Returns the last frame at or before a tick. */
  frameAt(tick) {
    return Math.max(0, lastAtOrBefore(this.ticks, tick));
  }

  chunkOf(frame) {
    return lastAtOrBefore(this.begins, frame);
  }

  /** Returns the positions of a chunk. If they are not unpacked yet, returns `undefined` and starts unpacking. */
  unpacked(chunk) {
    const entry = this.cache.get(chunk);
    if (!entry) this.unpack(chunk);
    else {
      // Mark the chunk as the most recently used one.
      this.cache.delete(chunk);
      this.cache.set(chunk, entry);
    }
    return entry?.numbers;
  }

  /** Unpacks a chunk. The promise resolves when its positions are in memory. */
  unpack(chunk) {
    const known = this.cache.get(chunk);
    if (known) return known.promise;
    const entry = {};
    this.cache.set(chunk, entry);
    entry.promise = this.decode(chunk).then(numbers => {
      entry.numbers = numbers;
      this.cached += numbers.byteLength;
      for (const [old, { numbers: unpacked }] of this.cache) {
        if (this.cached <= CACHE || old === chunk) break;
        if (!unpacked) continue;
        this.cached -= unpacked.byteLength;
        this.cache.delete(old);
      }
    });
    return entry.promise;
  }

  /** Resolves with the numbers of a chunk: 7 for each block and tick. The tick varies fastest. */
  async decode(index) {
    const { from, to, ticks } = this.chunks[index];
    const frames = ticks.length;
    const planes = await inflate(this.data.bytes(from, to));
    const count = 7 * this.bodies * frames;
    if (planes.length !== 2 * count) throw new Unreadable('The recording in this page is damaged.');
    const numbers = new Uint16Array(count);
    for (let start = 0; start < count; start += frames) {
      let before = 0;
      let change = 0;
      for (let frame = 0; frame < frames; frame++) {
        const zigzag = planes[start + frame] | (planes[count + start + frame] << 8);
        const second = (zigzag >> 1) ^ -(zigzag & 1);
        change = frame < 2 ? second : second + change;
        before = (before + change) & 0xffff;
        numbers[start + frame] = before;
      }
    }
    return numbers;
  }

  /** Returns whether the positions around a tick are unpacked. Also starts unpacking the next chunk. */
  has(tick) {
    const frame = this.frameAt(tick);
    const chunk = this.chunkOf(frame);
    const next = this.chunkOf(Math.min(frame + 1, this.ticks.length - 1));
    const here = this.unpacked(chunk) && this.unpacked(next);
    if (here && next + 1 < this.chunks.length) this.unpack(next + 1);
    return Boolean(here);
  }

  /** Resolves when [`has`] returns true for a tick. */
  async fetch(tick) {
    const frame = this.frameAt(tick);
    await this.unpack(this.chunkOf(frame));
    await this.unpack(this.chunkOf(Math.min(frame + 1, this.ticks.length - 1)));
  }

  /**
   * Writes the positions of all blocks at a tick to `out`. A position is x, y, z [block lengths] and a quaternion x,
   * y, z, w. Between two frames, positions are interpolated linearly. The tick may be a fraction.
   */
  places(tick, out) {
    const frame = this.frameAt(tick);
    const next = Math.min(frame + 1, this.ticks.length - 1);
    const span = this.ticks[next] - this.ticks[frame];
    const part = span > 0 ? Math.min(1, Math.max(0, (tick - this.ticks[frame]) / span)) : 0;
    const [here, there] = [this.reader(frame), this.reader(part > 0 ? next : frame)];
    const a = new Float64Array(7);
    const b = new Float64Array(7);
    for (let body = 0; body < this.bodies; body++) {
      here(body, a);
      there(body, b);
      let product = 0;
      for (let i = 3; i < 7; i++) product += a[i] * b[i];
      const sign = product < 0 ? -1 : 1;
      let square = 0;
      for (let i = 0; i < 7; i++) {
        a[i] += part * ((i < 3 ? 1 : sign) * b[i] - a[i]);
        if (i > 2) square += a[i] * a[i];
      }
      const length = Math.sqrt(square) || 1;
      for (let i = 0; i < 7; i++) out[7 * body + i] = i < 3 ? a[i] : a[i] / length;
    }
    return out;
  }

  /** Returns a function that reads the positions of one frame. */
  reader(frame) {
    const index = this.chunkOf(frame);
    const numbers = this.cache.get(index).numbers;
    const { ticks, corner, step } = this.chunks[index];
    const [frames, bodies] = [ticks.length, this.bodies];
    const inside = frame - this.begins[index];
    return (body, into) => {
      for (let i = 0; i < 7; i++) {
        const number = numbers[(i * bodies + body) * frames + inside];
        into[i] = i < 3 ? corner[i] + step * number : ((number << 16) >> 16) / 4095;
      }
    };
  }
}

/** Returns the header of a chunk, which precedes its packed positions. */
function chunkHead(data, from, to) {
  const head = new DataView(data.bytes(from, from + 48).buffer);
  const first = Number(head.getBigUint64(0, true));
  const frames = head.getUint32(8, true);
  const begin = from + 48 + 4 * frames;
  if (begin > to) throw new Unreadable(CUT_SHORT);
  const offsets = new DataView(data.bytes(from + 48, begin).buffer);
  return {
    from: begin,
    to,
    ticks: Array.from({ length: frames }, (_, i) => first + offsets.getUint32(4 * i, true)),
    corner: [16, 24, 32].map(at => head.getFloat64(at, true)),
    step: head.getFloat64(40, true),
  };
}

/** Returns the index of the last number in an ascending list that is at most `value`. Returns -1 if there is none. */
function lastAtOrBefore(list, value) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
