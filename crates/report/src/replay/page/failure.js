// Error messages in place of a blank page.

/** Error of the recording or the browser, with a message for the reader. */
class Unreadable extends Error {}

/** Shows an error message in place of the arena. */
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
