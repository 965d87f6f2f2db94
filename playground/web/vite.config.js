import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

const path = relative => fileURLToPath(new URL(relative, import.meta.url));

/** Parts of the replay's script that draw the arena. Each uses only earlier parts, as in the replay. */
const PARTS = [
  'maths', 'recording', 'groups', 'history', 'theme', 'camera', 'shapes', 'shell', 'shaders', 'painter', 'sheet', 'axes', 'arrows', 'labels', 'sight', 'cloud', 'target', 'scene', 'panel', 'timeline', 'player',
];
const EXPORTS = ['Camera', 'History', 'Labels', 'Painter', 'Player', 'Recording', 'Scene', 'SPEEDS', 'Timeline', 'Unreadable', 'phaseColour', 'steer'];

/**
 * Makes a module from the viewer of `stochc replay`. It exports a function of the palette, which the engine supplies.
 */
function viewer() {
  const folder = path('../../crates/report/src/replay/page');
  return {
    name: 'viewer',
    resolveId: id => (id === 'virtual:viewer' ? '\0viewer' : null),
    load(id) {
      if (id !== '\0viewer') return null;
      const text = PARTS.map(part => readFileSync(`${folder}/${part}.js`, 'utf8')).join('\n');
      return `export function viewer(PALETTE) {\nclass Unreadable extends Error {}\nconst element = id => document.getElementById(id);\n${text}\nreturn { ${EXPORTS.join(', ')} };\n}`;
    },
  };
}

/** Includes the pictures of the examples as text, so that the page needs no further requests. */
function pictures() {
  const folder = path('../../docs/pictures/examples');
  return {
    name: 'pictures',
    resolveId: id => (id === 'virtual:pictures' ? '\0pictures' : null),
    load(id) {
      if (id !== '\0pictures') return null;
      const names = ['gate', 'line', 'open_platform', 'closed_platform', 'five_tower', 'five_tower_reconfigured', 'experiment_1', 'suction_growth', 'microns', 'bowl', 'tank', 'air_table', 'chair', 'serpentine'];
      const all = names.map(name => [name, readFileSync(`${folder}/${name}.svg`, 'utf8')]);
      return `export default ${JSON.stringify(Object.fromEntries(all))};`;
    },
  };
}

/** Exports the keywords and unit symbols of the grammar. */
function words() {
  const grammar = readFileSync(path('../../grammar/src/sa.pest'), 'utf8');
  const strings = rule => [...(grammar.match(new RegExp(`^${rule} *= *(.*)$`, 'm'))?.[1] ?? '').matchAll(/"([^"]+)"/g)].map(([, word]) => JSON.parse(`"${word.replace(/\\u\{(\w+)\}/g, (_, code) => `\\u${code.padStart(4, '0')}`)}"`));
  const keywords = [...grammar.matchAll(/^kw_\w+ *= *@\{ "(\w+)"/gm)].map(([, word]) => word);
  const lists = { KEYWORDS: [...keywords, ...strings('verdict')], PREFIXES: strings('unit_prefix'), UNITS: strings('unit_base') };
  for (const [name, list] of Object.entries(lists)) if (!list.length) throw new Error(`the grammar has no ${name}`);
  return {
    name: 'words',
    resolveId: id => (id === 'virtual:words' ? '\0words' : null),
    load: id => (id === '\0words' ? Object.entries(lists).map(([name, list]) => `export const ${name} = ${JSON.stringify(list)};`).join('\n') : null),
  };
}

export default defineConfig({
  base: './',
  plugins: [viewer(), pictures(), words()],
  worker: { format: 'es' },
  logLevel: 'warn',
  build: { chunkSizeWarningLimit: 1000, outDir: '../dist', emptyOutDir: true, assetsInlineLimit: 0, target: 'es2022', modulePreload: false },
  server: { fs: { allow: [path('../..')] } },
});
