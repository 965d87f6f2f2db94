// Shows an error instead of a blank page.

/** Something about the recording or the browser that the reader can be told in words. */
class Unreadable extends Error {}

/** Shows a message in the place of the arena. */
function fail(reason) {
  const message = document.getElementById('message');
  message.hidden = false;
  message.textContent = reason;
  document.body.classList.add('failed');
}

addEventListener('error', event => fail(`This page has stopped: ${event.message}`));
addEventListener('unhandledrejection', event => {
  const known = event.reason instanceof Unreadable;
  fail(known ? event.reason.message : `This page has stopped: ${event.reason}`);
});
