// Transparent canvas above the arena. It is as small as possible, because the browser blends all
// its pixels.

/** Step in which sheets grow and shrink [px]. A large step avoids frequent changes of the size. */
const GRAIN = 64;
/** Largest number of names, and of arrows. Above it, those behind blocks are drawn as well. */
const MANY = 400;
/** Smallest size of a block with a name or an arrow [px]. */
const SMALLEST = 13;

class Sheet {
  /** `holder` is as large as the arena and contains only sheets. */
  constructor(holder, name) {
    this.canvas = holder.appendChild(document.createElement('canvas'));
    this.canvas.className = name;
    this.canvas.hidden = true;
    this.pen = this.canvas.getContext('2d');
  }

  /**
   * Clears the sheet and moves it over the boxes in an arena of this size [px]. A box is [left, top, right, bottom].
   * The pen then also uses pixels of the page. `scale` is the number of pixels of the sheet per pixel of the page.
   */
  cover(boxes, { width, height }, scale) {
    const { canvas, pen } = this;
    const wide = (first, last, end) => {
      const from = Math.max(0, GRAIN * Math.floor((first * scale) / GRAIN));
      return [from, Math.max(from, Math.min(Math.round(end * scale), GRAIN * Math.ceil((last * scale) / GRAIN)))];
    };
    const most = (side, i) => side(...boxes.map(box => box[i]));
    const [left, right] = wide(most(Math.min, 0), most(Math.max, 2), width);
    const [top, bottom] = wide(most(Math.min, 1), most(Math.max, 3), height);
    // An empty list of boxes has no bounds.
    canvas.hidden = !boxes.length || right === left || bottom === top;
    if (canvas.hidden) return;
    Object.assign(this, { left, top });
    // Setting the size to the same value would clear the canvas.
    if (canvas.width !== right - left) canvas.width = right - left;
    if (canvas.height !== bottom - top) canvas.height = bottom - top;
    const place = { left, top, width: right - left, height: bottom - top };
    for (const [name, pixels] of Object.entries(place)) canvas.style[name] = `${pixels / scale}px`;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.setTransform(scale, 0, 0, scale, -left, -top);
  }

  /** Draws the content of the sheet onto a picture that is as large as the arena. */
  paint(pen) {
    if (!this.canvas.hidden) pen.drawImage(this.canvas, this.left, this.top);
  }
}
