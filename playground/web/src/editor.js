// Editor for programs.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, indentWithTab } from '@codemirror/commands';
import { bracketMatching, HighlightStyle, indentOnInput, indentUnit, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, lintKeymap, setDiagnostics } from '@codemirror/lint';
import { searchKeymap } from '@codemirror/search';
import { Compartment, EditorState } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, hoverTooltip, keymap, lineNumbers } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { completion, stochc } from './language.js';

// Colours are custom properties of CSS, so that both themes share one style.
const colours = HighlightStyle.define([
  { tag: tags.keyword, color: 'var(--code-keyword)', fontWeight: '600' },
  { tag: [tags.modifier, tags.controlOperator], color: 'var(--code-keyword)' },
  { tag: tags.propertyName, color: 'var(--code-face)' },
  { tag: [tags.number, tags.string, tags.bool], color: 'var(--code-value)' },
  { tag: tags.typeName, color: 'var(--code-type)' },
  { tag: [tags.lineComment, tags.docComment], color: 'var(--soft)', fontStyle: 'italic' },
]);

/** Returns a function that converts byte offsets of the engine to UTF-16 offsets of the editor. */
export function units(text) {
  if (/^[\0-\x7f]*$/.test(text)) return offset => Math.min(offset, text.length);
  const at = [];
  let unit = 0;
  for (const character of text) {
    const point = character.codePointAt(0);
    const bytes = point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
    for (let i = 0; i < bytes; i++) at.push(unit);
    unit += character.length;
  }
  return offset => at[offset] ?? text.length;
}

export class Editor {
  /**
   * Calls `changed` after edits, and `moved` with the offset of the cursor. `names` and `terms` are offered for
   * completion. `hover` returns the description of an offset.
   */
  constructor(parent, { changed, moved, names, terms, hover, run, format }) {
    const command = act => () => {
      act();
      return true;
    };
    this.quiet = new Compartment();
    this.extensions = [
      lineNumbers(), highlightActiveLineGutter(), lintGutter(), history(), drawSelection(), indentOnInput(), bracketMatching(), closeBrackets(), highlightActiveLine(),
      indentUnit.of('    '), EditorState.tabSize.of(4), stochc(terms), syntaxHighlighting(colours),
      autocompletion({ override: [completion(names, terms)], icons: false }),
      hoverTooltip((_, position) => {
        const found = hover(position);
        return found && {
          pos: found.from,
          end: found.to,
          create() {
            const dom = document.createElement('div');
            dom.className = 'hover';
            dom.append(...found.lines.map((line, i) => Object.assign(document.createElement(i ? 'div' : 'strong'), { textContent: line })));
            return { dom };
          },
        };
      }),
      // Escape followed by Tab leaves the editor.
      keymap.of([
        { key: 'Mod-Enter', run: command(run) },
        { key: 'Shift-Alt-f', run: command(format) },
        ...closeBracketsKeymap, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...completionKeymap, ...lintKeymap, indentWithTab,
      ]),
      EditorView.contentAttributes.of({ 'aria-label': 'program', tabindex: '0' }),
      EditorView.updateListener.of(update => {
        if (update.docChanged) changed();
        if (update.selectionSet || update.docChanged) moved(update.state.selection.main.head);
      }),
    ];
    this.view = new EditorView({ parent, state: this.state('') });
  }

  state(text) {
    return EditorState.create({ doc: text, extensions: this.extensions });
  }

  get text() {
    return this.view.state.doc.toString();
  }

  /** Opens another program, with a new edit history. */
  open(text) {
    this.view.setState(this.state(text));
  }

  /** Replaces the whole text as one step that can be undone. */
  replace(text) {
    const { view } = this;
    const old = this.text;
    // Replace only the part that differs, so that the cursor stays in place.
    let from = 0;
    while (from < Math.min(old.length, text.length) && old[from] === text[from]) from++;
    let [end, newEnd] = [old.length, text.length];
    while (end > from && newEnd > from && old[end - 1] === text[newEnd - 1]) [end, newEnd] = [end - 1, newEnd - 1];
    if (from === end && from === newEnd) return false;
    view.dispatch({ changes: { from, to: end, insert: text.slice(from, newEnd) }, userEvent: 'input.format' });
    return true;
  }

  /** Applies the edits of a fix as one step that can be undone. */
  edit(edits) {
    this.view.dispatch({ changes: edits.map(({ from, to, text }) => ({ from, to, insert: text })), userEvent: 'input.fix', scrollIntoView: true });
    this.view.focus();
  }

  select(from, to) {
    const { view } = this;
    const end = view.state.doc.length;
    view.dispatch({ selection: { anchor: Math.min(from, end), head: Math.min(to, end) }, effects: EditorView.scrollIntoView(Math.min(from, end), { y: 'center' }) });
  }

  /** Marks diagnostics in the text. Each is `{ from, to, severity, message, actions }`. */
  mark(diagnostics) {
    const end = this.view.state.doc.length;
    const fitting = diagnostics.map(it => ({ ...it, from: Math.min(it.from, end), to: Math.min(it.to, end) }));
    this.view.dispatch(setDiagnostics(this.view.state, fitting));
  }

  focus() {
    this.view.focus();
  }
}
