// Calls of the engine (playground/engine), which runs in workers.
import EngineWorker from './worker.js?worker&inline';

let module;

/** Loads the engine. Later calls reuse it. */
export async function load(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`the engine cannot be loaded: ${response.status}`);
  // Streaming requires that the server sends the media type of WebAssembly. Otherwise, compile the
  // whole file.
  module = await WebAssembly.compile(await response.arrayBuffer());
}

/** Engine in a worker. It answers one request at a time. */
export class Engine {
  constructor() {
    this.jobs = new Map();
    this.next = 0;
    this.begin();
  }

  begin() {
    this.worker = new EngineWorker();
    this.worker.postMessage({ module });
    this.worker.onmessage = ({ data }) => {
      const job = this.jobs.get(data.job);
      if (!job) return;
      if (data.batch) return job.batch?.(data.batch, data.numbers);
      this.jobs.delete(data.job);
      if (data.broken) this.stop();
      if (data.reply?.error) job.reject(new Error(data.reply.error));
      else job.resolve(data.reply);
    };
  }

  /** Sends a request and resolves with the reply. `batch` receives frames. */
  call(request, batch) {
    const job = this.next++;
    return new Promise((resolve, reject) => {
      this.jobs.set(job, { resolve, reject, batch });
      this.worker.postMessage({ job, request });
    });
  }

  /** Stops a running request. The next call starts a new worker. */
  stop() {
    this.worker.terminate();
    for (const { reject } of this.jobs.values()) reject(new Stopped());
    this.jobs.clear();
    this.begin();
  }

  close() {
    this.worker.terminate();
    for (const { reject } of this.jobs.values()) reject(new Stopped());
    this.jobs.clear();
  }
}

/** Error of a request that was stopped. */
export class Stopped extends Error {
  constructor() {
    super('stopped');
  }
}
