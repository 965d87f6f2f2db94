// Conversion of pages of `stochc explain` to HTML. They use headings, paragraphs, lists, code and
// emphasis.

const escaped = text => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');

function inline(text) {
  // Convert code first, because it contains no emphasis.
  return text.split(/(`[^`]+`)/).map(part => (part.startsWith('`') && part.length > 1 ? `<code>${escaped(part.slice(1, -1))}</code>` : escaped(part).replace(/\*\*([^*]+)\*\*/g, '<b>$1</b>').replace(/\*([^*]+)\*/g, '<em>$1</em>').replace(/\[([^\]]+)\]\([^)]*\)/g, '$1'))).join('');
}

export function markdown(text) {
  const out = [];
  let [paragraph, list, code] = [[], null, null];
  const flush = () => {
    if (paragraph.length) out.push(`<p>${inline(paragraph.join(' '))}</p>`);
    if (list) out.push(`<ul>${list.map(item => `<li>${inline(item)}</li>`).join('')}</ul>`);
    [paragraph, list] = [[], null];
  };
  for (const line of text.split('\n')) {
    if (line.startsWith('```')) {
      if (code) {
        out.push(`<pre tabindex="0"><code>${escaped(code.join('\n'))}</code></pre>`);
        code = null;
      } else {
        flush();
        code = [];
      }
    } else if (code) code.push(line);
    else if (/^#+ /.test(line)) {
      flush();
      out.push(`<h3>${inline(line.replace(/^#+ /, ''))}</h3>`);
    } else if (/^[-*] /.test(line)) {
      if (paragraph.length) flush();
      (list ??= []).push(line.slice(2));
    } else if (list && /^\s+\S/.test(line)) list[list.length - 1] += ` ${line.trim()}`;
    else if (!line.trim()) flush();
    else {
      if (list) flush();
      paragraph.push(line.trim());
    }
  }
  flush();
  return out.join('\n');
}
