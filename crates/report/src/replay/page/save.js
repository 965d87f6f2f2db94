// Controls for saving pictures and films.

/** `replay` returns `window.replay` after the page has loaded. */
function save(about, recording, player, replay) {
  const whole = id => Number(element(id).value);
  const name = ending => `${about.program}-${recording.header.run}-${Math.floor(player.tick)}.${ending}`;
  const busy = async (ending, make) => {
    text('saved', 'under way …');
    for (const id of ['png', 'film']) element(id).disabled = true;
    try {
      const blob = await make();
      keep(blob, name(ending));
      text('saved', `${Math.ceil(blob.size / 1024)} kB`);
    } catch (error) {
      text('saved', error.message);
    }
    for (const id of ['png', 'film']) element(id).disabled = false;
  };
  element('to').value = element('to').max = element('from').max = recording.record.ticks;
  element('png').addEventListener('click', () => busy('png', () => replay().png(whole('width'), whole('height'))));
  const stretch = () => ({ from: whole('from'), to: whole('to'), width: whole('width'), height: whole('height') });
  element('film').addEventListener('click', () => busy('webm', () => replay().film(stretch())));
}
