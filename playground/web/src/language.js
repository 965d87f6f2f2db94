// Highlighting and completion of programs.
import { indentService, LanguageSupport, StreamLanguage } from '@codemirror/language';
import { KEYWORDS, PREFIXES, UNITS } from 'virtual:words';

/** Keywords that begin statements and declarations. */
const HEADS = new Set(['assembly', 'aggregate', 'pattern', 'scene', 'shape', 'phase', 'seed', 'plate', 'layer', 'import', 'for', 'let']);
const WORDS = new Set(KEYWORDS);
const FACES = ['up', 'down', 'north', 'south', 'east', 'west'];
const UNIT = new RegExp(`^[ \\t]*(?:(?:${PREFIXES.join('|')})?(?:${UNITS.join('|')})(?![A-Za-z0-9_]))`);

/** `terms` are the words that begin the clauses of scenes. */
const language = terms => StreamLanguage.define({
  name: 'stochc',
  startState: () => ({ shape: 0, depth: 0 }),
  token(stream, state) {
    if (stream.eatSpace()) return null;
    if (stream.match(/^\/\/\/.*/)) return 'docComment';
    if (stream.match(/^\/\/.*/)) return 'lineComment';
    if (stream.match(/^"(?:[^"\\]|\\.)*"?/)) return 'string';
    if (stream.match(/^->>?/)) return 'controlOperator';
    if (stream.match(/^\d+(?:\.\d+)?(?:e[+-]?\d+)?/)) {
      stream.match(UNIT);
      return 'number';
    }
    if (stream.match(/^\.\.|^[{}()[\],.+*/%=<>-]/)) return 'punctuation';
    if (stream.match(/^#/)) return 'bool';
    const word = stream.match(/^[\p{L}_][\p{L}\p{N}_]*/u)?.[0];
    if (!word) {
      stream.next();
      return null;
    }
    if (HEADS.has(word)) return 'keyword';
    if (WORDS.has(word)) return 'modifier';
    if (FACES.includes(word) && stream.string[stream.start - 1] === '.') return 'propertyName';
    if (terms.includes(word)) return 'typeName';
    return 'variableName';
  },
  languageData: { commentTokens: { line: '//' }, closeBrackets: { brackets: ['(', '[', '{', '"'] }, indentOnInput: /^\s*\}$/ },
});

/** Indents a line like the line before it, and by one step more after an opening bracket. */
const indentation = indentService.of((context, position) => {
  const { doc } = context.state;
  // At a new line, the line before it ends at this position.
  const end = context.simulatedBreak === position ? position : Math.max(0, position - 1);
  const before = doc.sliceString(doc.lineAt(end).from, end);
  const steps = /[{([]\s*(\/\/.*)?$/.test(before) - /^\s*\}/.test(context.lineAt(position).text);
  return Math.max(0, before.search(/\S|$/) + steps * context.unit);
});

export const stochc = terms => new LanguageSupport(language(terms), indentation);

/**
 * Returns a completion source. It offers faces after a dot, `terms` in scenes, keywords, and names of the program. It
 * offers nothing for the name of a new block after an arrow.
 */
export const completion = (names, terms) => context => {
  const face = context.matchBefore(/\.\w*/);
  if (face) return { from: face.from + 1, options: FACES.map(label => ({ label, type: 'property' })), validFor: /^\w*$/ };
  const word = context.matchBefore(/[\p{L}_][\p{L}\p{N}_]*/u);
  if (!context.explicit && (!word || context.matchBefore(/->>?\s*\w*/))) return null;
  const text = context.state.doc.toString();
  const known = [...new Set([...names(), ...(text.match(/\b[A-Z][A-Za-z0-9_]*\b/g) ?? [])])].filter(name => name !== word?.text);
  const declaration = text.slice(0, context.pos).match(/^(?:assembly|aggregate|pattern|scene|shape)\b/gm)?.at(-1);
  // Names of blocks usually begin with a capital letter, and keywords never do.
  const keywords = /^[A-Z]/.test(word?.text ?? '') ? [] : declaration === 'scene' ? [...terms, ...KEYWORDS] : KEYWORDS;
  const options = [...known.map(label => ({ label, type: 'variable', boost: 1 })), ...keywords.map(label => ({ label, type: 'keyword' }))];
  return { from: word?.from ?? context.pos, options, validFor: /^[\p{L}\p{N}_]*$/u };
};
