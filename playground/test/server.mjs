// File server for a folder.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname } from 'node:path';
import { fileURLToPath } from 'node:url';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };

/** Serves a folder, relative to this one. Returns `{ url, requests, close }`. `requests` lists the paths asked for. */
export async function serve(folder = '../dist') {
  const root = fileURLToPath(new URL(folder, import.meta.url));
  const requests = [];
  const server = createServer(async ({ url }, reply) => {
    const path = new URL(url, 'http://localhost').pathname;
    requests.push(path);
    try {
      const file = path.endsWith('/') ? `${path}index.html` : path;
      const bytes = await readFile(root + file);
      reply.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' }).end(bytes);
    } catch {
      reply.writeHead(404).end();
    }
  });
  await new Promise(ready => server.listen(0, '127.0.0.1', ready));
  return { url: `http://127.0.0.1:${server.address().port}/`, requests, close: () => server.close() };
}
