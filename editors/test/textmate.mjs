// Tokenizes programs with the TextMate grammar and compares each token with its pest rule: `node textmate.mjs TOKENS.jsonl`.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const require = createRequire(new URL('../vscode/', import.meta.url));
const oniguruma = require('vscode-oniguruma');
const textmate = require('vscode-textmate');

const read = path => readFileSync(new URL(path, import.meta.url), 'utf8');
await oniguruma.loadWASM(readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm')).buffer);
const registry = new textmate.Registry({
  onigLib: { createOnigScanner: it => oniguruma.createOnigScanner(it), createOnigString: it => oniguruma.createOnigString(it) },
  loadGrammar: () => textmate.parseRawGrammar(read('../vscode/syntaxes/stochc.tmLanguage.json'), 'stochc.json'),
});
const grammar = await registry.loadGrammar('source.stochc');
const scopes = JSON.parse(read('scopes.json'));

let [tokens, programs] = [0, 0];
const problems = [];
for (const program of readFileSync(process.argv[2], 'utf8').trim().split('\n').map(line => JSON.parse(line))) {
  programs += 1;
  const found = new Map();
  let stack = textmate.INITIAL;
  let start = 0;
  for (const line of program.text.split('\n')) {
    const tokenized = grammar.tokenizeLine(line, stack);
    stack = tokenized.ruleStack;
    // Positions in UTF-16; those of pest are bytes.
    let [unit, at] = [0, start];
    for (const token of tokenized.tokens) {
      at += Buffer.byteLength(line.slice(unit, token.startIndex));
      unit = token.startIndex;
      const end = at + Buffer.byteLength(line.slice(unit, token.endIndex));
      found.set(at, [end, token.scopes.at(-1)]);
    }
    start += Buffer.byteLength(line) + 1;
  }
  for (const [from, to, kind] of program.tokens) {
    tokens += 1;
    const [end, scope] = found.get(from) ?? [];
    if (scope === scopes[kind][0] && end === to) continue;
    const before = Buffer.from(program.text).subarray(0, from).toString();
    const token = Buffer.from(program.text).subarray(from, to).toString();
    problems.push(`${program.path}:${before.split('\n').length}: \`${token}\` is a ${kind}, scope ${scope}`);
  }
}
console.log(`TextMate: ${tokens} tokens of ${programs} programs`);
if (problems.length) {
  console.error([`${problems.length} problems`, ...problems.slice(0, 20)].join('\n'));
  process.exit(1);
}
