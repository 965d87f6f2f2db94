// How far the ensemble is, in numbers and as curves.

/** Shows the numbers. */
function tell(told) {
  const { done, total, completed, stopped, failed, left, passed, programs, more } = told;
  document.getElementById('share').value = total ? done / total : 0;
  const shown = [
    ['runs done', `${done} of ${total}`],
    ['completed', completed],
    ['stopped', stopped],
    ['failed', failed],
    ['time passed', passed],
    ['time left', done === total ? 'none' : left ? `about ${left}` : 'not known yet'],
  ];
  const list = document.getElementById('numbers');
  if (!list.childElementCount) {
    for (const [name] of shown) {
      const pair = list.appendChild(document.createElement('div'));
      pair.append(line('dt', name), line('dd', ''));
    }
  }
  shown.forEach(([, value], i) => write(list.children[i].lastChild, String(value)));
  const table = document.getElementById('programs');
  table.hidden = programs.length < 2;
  if (table.hidden) return;
  const rows = programs.map(({ name, done, left }) => [name, `${done} of ${done + left}`]);
  if (more) rows.push([`and ${more} more`, '']);
  const body = table.tBodies[0];
  while (body.rows.length < rows.length) {
    const head = line('th', '');
    head.scope = 'row';
    body.insertRow().append(head, line('td', ''));
  }
  rows.forEach((row, i) => row.forEach((words, j) => write(body.rows[i].cells[j], words)));
}

/** Shows the curves, which `svg` holds with every name escaped. */
function draw(svg) {
  const picture = new DOMParser().parseFromString(svg, 'text/html').querySelector('svg');
  picture.removeAttribute('width');
  picture.removeAttribute('height');
  document.getElementById('curve').replaceChildren(document.importNode(picture, true));
}

/** An element with a text, which is never read as HTML. */
function line(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function write(place, words) {
  if (place.textContent !== words) place.textContent = words;
}
