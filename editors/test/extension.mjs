// Tests the extension of VS Code without VS Code: `node extension.mjs STOCHC SNIPPETS`. Writes each snippet as a program into
// the folder SNIPPETS.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import Module, { createRequire } from 'node:module';
import { resolve } from 'node:path';

const [stochc, folder] = process.argv.slice(2);
const vscode = new URL('../vscode/', import.meta.url);
const require = createRequire(vscode);
const json = path => JSON.parse(readFileSync(new URL(path, vscode), 'utf8'));

// The placeholders of a snippet have values that make a program.
mkdirSync(folder, { recursive: true });
for (const [name, { body }] of Object.entries(json('snippets/stochc.json'))) {
  let text = [body].flat().join('\n');
  text = text.replace(/\$\{\d+\|([^,]*),[^}]*\}/g, '$1').replace(/\$\{\d+:([^}]*)\}/g, '$1').replace(/\$0/g, '');
  writeFileSync(`${folder}/${name}.sa`, `${text}\n`);
}

// The structure of an example, and the messages of a program that is wrong.
const { page, programs } = require('./src/structure.js');
const { run } = require('./src/simulation.js');
assert.deepEqual(programs('assembly a in b {\n}\n  aggregate c to 3\n// assembly d'), ['a', 'c']);
const picture = await page(resolve(stochc), 'examples/suction_growth.sa', 'together');
assert.match(picture, /<svg[^>]*>[\s\S]*<\/svg>/);
assert.doesNotMatch(picture, /<\?xml/);
assert.match(await page(resolve(stochc), 'examples/nothing.sa'), /<pre>.*nothing\.sa/);
assert.match(await page('no-such-command', 'examples/gate.sa'), /cannot run no-such-command/);

// The bundle needs nothing but the module of the editor, and has the commands of the manifest.
const anything = new Proxy(class {}, { get: (it, key) => (key === 'prototype' ? it.prototype : anything), apply: () => anything });
const load = Module._load;
Module._load = (request, ...rest) => (request === 'vscode' ? anything : load(request, ...rest));
const extension = require('./dist/extension.js');
assert.equal(typeof extension.activate, 'function');
const source = readFileSync(new URL('src/extension.js', vscode), 'utf8');
for (const { command } of json('package.json').contributes.commands) {
  assert.ok(source.includes(`registerCommand('${command}'`), command);
}

// A simulation saves the file, and runs the command without a shell.
const calls = [];
const uri = text => ({ toString: () => text, fsPath: text.replace('file://', '') });
const editor = {
  Uri: { parse: uri },
  TaskScope: { Workspace: 2 },
  ProcessExecution: class { constructor(...words) { this.words = words; } },
  Task: class { constructor(...parts) { this.run = parts[4]; } },
  workspace: { textDocuments: [{ uri: uri('file:///a b.sa'), save: async () => calls.push('saved') }] },
  tasks: { executeTask: async ({ run }) => calls.push(run.words) },
};
for (const subcommand of ['simulate', 'test']) {
  await run(editor, 'stochc', subcommand, 'file:///a b.sa');
  assert.deepEqual(calls.splice(0), ['saved', ['stochc', [subcommand, '/a b.sa']]]);
}
console.log('VS Code: snippets, structure, simulation and bundle');
