// A picture of the structure, made by the command.
const { execFile } = require('node:child_process');

/** Names of the assemblies and aggregates in a program. */
const programs = text => [...text.matchAll(/^[ \t]*(?:assembly|aggregate)\s+([A-Za-z_]\w*)/gm)].map(found => found[1]);

const escaped = text => text.replace(/[&<>]/g, sign => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;' })[sign]);

/** Returns a page with the structure of a program, or with the messages of the command. */
function page(command, file, program) {
  const options = ['compile', file, '--emit', 'structure', '--format', 'svg', ...(program ? ['--program', program] : [])];
  const policy = `<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; font-src data:">`;
  return new Promise(resolve => {
    execFile(command, options, { maxBuffer: 1 << 26 }, (error, picture, messages) => {
      const content = error
        ? `<pre>${escaped(messages || `cannot run ${command}: ${error.message}`)}</pre>`
        : `<div class="picture">${picture.replace(/^<\?xml[^>]*>\s*/, '')}</div>`;
      resolve(`<!doctype html><html lang="en"><head>${policy}<style>
        .picture { background: #fff; padding: 1em; } svg { max-width: 100%; height: auto; } pre { white-space: pre-wrap; }
      </style></head><body>${content}</body></html>`);
    });
  });
}

module.exports = { page, programs };
