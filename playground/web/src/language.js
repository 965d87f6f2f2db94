// Highlighting and completion of programs.
import { LanguageSupport, StreamLanguage } from '@codemirror/language';

/** Keywords that begin statements and declarations. */
const HEADS = ['assembly', 'aggregate', 'pattern', 'scene', 'shape', 'phase', 'seed', 'plate', 'layer', 'import', 'for', 'let'];
const WORDS = ['after', 'allow', 'as', 'at', 'deny', 'from', 'in', 'release', 'timeout', 'to', 'warn', 'yields'];
const FACES = ['up', 'down', 'north', 'south', 'east', 'west'];
const TERMS = ['tick', 'block', 'free', 'enclosure', 'gravity', 'fluid', 'flow', 'agitation', 'contact', 'bond', 'messages'];
const UNITS = /^(ticks?|s|min|h|ms|mm|cm|m|um|nm|kg|g|mg|ng|N|mN|nN|fN|K|Pa|mPa|rev|deg|rad)\b/;

const language = StreamLanguage.define({
  name: 'stochc',
  startState: () => ({ shape: 0, depth: 0 }),
  token(stream, state) {
    if (stream.eatSpace()) return null;
    if (stream.match(/^\/\/\/.*/)) return 'docComment';
    if (stream.match(/^\/\/.*/)) return 'lineComment';
    if (stream.match(/^"(?:[^"\\]|\\.)*"?/)) return 'string';
    if (stream.match(/^->>?/)) return 'controlOperator';
    if (stream.match(/^\d+(?:\.\d+)?(?:e[+-]?\d+)?/)) {
      stream.match(UNITS) || stream.match('%');
      return 'number';
    }
    if (stream.match(/^\.\.|^[{}()[\],.+*/%=<>-]/)) return 'punctuation';
    if (stream.match(/^#/)) return 'bool';
    const word = stream.match(/^[\p{L}_][\p{L}\p{N}_]*/u)?.[0];
    if (!word) {
      stream.next();
      return null;
    }
    if (HEADS.includes(word)) return 'keyword';
    if (WORDS.includes(word)) return 'modifier';
    if (FACES.includes(word) && stream.string[stream.start - 1] === '.') return 'propertyName';
    if (TERMS.includes(word)) return 'typeName';
    return 'variableName';
  },
  languageData: { commentTokens: { line: '//' }, closeBrackets: { brackets: ['(', '[', '{', '"'] }, indentOnInput: /^\s*\}$/ },
  indent(state, textAfter, context) {
    const before = context.lineAt(context.pos, -1);
    const indent = context.lineIndent(before.from > 0 ? before.from : 0);
    const opens = /[{(]\s*(\/\/.*)?$/.test(before.text);
    return indent + (opens ? context.unit : 0) - (/^\s*\}/.test(textAfter) && !opens ? context.unit : 0);
  },
});

export const stochc = () => new LanguageSupport(language);

/** Returns a completion source. It offers faces after a dot, otherwise keywords and the names of the program. */
export const completion = names => context => {
  const face = context.matchBefore(/\.\w*/);
  if (face) return { from: face.from + 1, options: FACES.map(label => ({ label, type: 'property' })), validFor: /^\w*$/ };
  const word = context.matchBefore(/[\p{L}_][\p{L}\p{N}_]*/u);
  if (!word && !context.explicit) return null;
  const known = [...new Set([...names(), ...(context.state.doc.toString().match(/\b[A-Z][A-Za-z0-9_]*\b/g) ?? [])])];
  const options = [
    ...known.filter(name => name !== word?.text).map(label => ({ label, type: 'variable', boost: 1 })),
    ...[...HEADS, ...WORDS].map(label => ({ label, type: 'keyword' })),
  ];
  return { from: word?.from ?? context.pos, options, validFor: /^[\p{L}\p{N}_]*$/u };
};
