// Drawing of cubes, lines and flat shapes with WebGL2.

/** Numbers that describe a cube: centre, quaternion, colour with opacity, mark. */
const CUBE = 12;
/** Size of blocks that are drawn as points if there is no graphics processor [px]. */
const SMALL = 12;

class Painter {
  /** Calls `restored` when the whole picture must be drawn again. */
  constructor(canvas, restored) {
    const slow = drawsSlowly();
    const gl = canvas.getContext('webgl2', { antialias: !slow, alpha: false });
    if (!gl) throw new Unreadable('This browser offers no WebGL2, which the arena needs. Switch it on, or use another browser.');
    this.gl = gl;
    this.canvas = canvas;
    this.lost = false;
    // A graphics processor is fast enough for many corners, and smooths only the edges of cubes.
    this.small = slow && gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE)[1] >= 4 * SMALL ? SMALL : 0;
    // A browser drops the graphics context in standby, or if too many pages use one. It then
    // returns an empty context.
    canvas.addEventListener('webglcontextlost', event => {
      event.preventDefault();
      this.lost = true;
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.lost = false;
      this.prepare();
      restored();
    });
    // Reading this value for every picture would force a new layout of the page each time.
    this.width = canvas.clientWidth;
    this.height = canvas.clientHeight;
    new ResizeObserver(() => {
      this.width = canvas.clientWidth;
      this.height = canvas.clientHeight;
    }).observe(canvas);
    this.prepare();
  }

  /** Sends programs and shapes that never change to the graphics processor. */
  prepare() {
    const { gl } = this;
    this.cubes = program(gl, CUBE_CORNERS, CUBE_PAINT);
    this.points = program(gl, POINT_CORNERS, POINT_PAINT);
    [this.plain, this.graded] = ['flat', 'smooth'].map(colours => program(gl, plainCorners(colours), plainPaint(colours)));
    this.corners = buffer(gl, cube());
    this.triangles = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, CUBE_TRIANGLES, gl.STATIC_DRAW);
    this.instances = gl.createBuffer();
    this.sketch = gl.createBuffer();
    this.fixed = new Map();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Fits the picture to the page. `scale` is the number of pixels of the picture per pixel of the screen. */
  fit(scale) {
    const width = Math.max(1, Math.round(this.width * scale));
    const height = Math.max(1, Math.round(this.height * scale));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
  }

  begin(camera, background) {
    this.view = camera.matrix(this.canvas.width, this.canvas.height);
    this.camera = camera;
    const { gl } = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    // Otherwise, the depths of the last picture would remain.
    gl.depthMask(true);
    gl.clearColor(...rgb(background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draws cubes. The first `far` of them are small in the picture. Opaque cubes hide everything farther away. */
  drawCubes(numbers, count, far, style) {
    if (!count) return;
    const { gl } = this;
    this.blend(!style.opaque);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, numbers.subarray(0, count * CUBE), gl.STREAM_DRAW);
    const parts = [[2, 3, 0], [3, 4, 12], [4, 4, 28], [5, 1, 44]];
    const from = (first, divisor) => {
      for (const [place, size, offset] of parts) attribute(gl, this.instances, place, size, 4 * CUBE, 4 * CUBE * first + offset, divisor);
    };
    if (far > 0) {
      const { points, camera, canvas } = this;
      this.dress(points, style);
      const up = Math.tan(camera.angle / 2);
      gl.uniformMatrix3fv(points.places.basis, false, camera.basis.flat());
      gl.uniform2f(points.places.lens, up * camera.aspect, up);
      gl.uniform2f(points.places.pixels, canvas.width, canvas.height);
      gl.uniform2f(points.places.depths, camera.lens[10], camera.lens[14]);
      from(0, 0);
      gl.drawArrays(gl.POINTS, 0, far);
    }
    if (far < count) {
      this.dress(this.cubes, style);
      attribute(gl, this.corners, 0, 3, 24, 0, 0);
      attribute(gl, this.corners, 1, 3, 24, 12, 0);
      from(far, 1);
      gl.drawElementsInstanced(gl.TRIANGLES, CUBE_TRIANGLES.length, gl.UNSIGNED_SHORT, 0, count - far);
    }
    for (let place = 2; place < 6; place++) {
      gl.vertexAttribDivisor(place, 0);
      gl.disableVertexAttribArray(place);
    }
  }

  /** Selects one of the programs that draw blocks, and sets the values that both programs use. */
  dress({ made, places }, { mark, pulled, edge }) {
    const { gl } = this;
    gl.useProgram(made);
    gl.uniformMatrix4fv(places.view, false, this.view);
    gl.uniform3fv(places.markColour, rgb(mark));
    gl.uniform3fv(places.pulledColour, rgb(pulled));
    gl.uniform1f(places.edgeShade, edge);
    gl.uniform3fv(places.eye, this.camera.eye);
  }

  /**
   * Draws a sketch. A sketch with a name is stored until the object `of` changes. `graded` states whether the corners
   * of a shape have different colours.
   */
  drawSketch(sketch, { lines, opaque, graded, name, of }) {
    const { gl } = this;
    let kept = name && this.fixed.get(name);
    if (!kept || kept.of !== of) {
      const numbers = new Float32Array(sketch().numbers);
      kept = { of, buffer: kept?.buffer ?? (name ? gl.createBuffer() : this.sketch), count: numbers.length / 7 };
      gl.bindBuffer(gl.ARRAY_BUFFER, kept.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
      if (name) this.fixed.set(name, kept);
    }
    if (!kept.count) return;
    const { made, places } = graded ? this.graded : this.plain;
    gl.useProgram(made);
    gl.uniformMatrix4fv(places.view, false, this.view);
    this.blend(!opaque);
    attribute(gl, kept.buffer, 0, 3, 28, 0, 0);
    attribute(gl, kept.buffer, 1, 4, 28, 12, 0);
    gl.drawArrays(lines ? gl.LINES : gl.TRIANGLES, 0, kept.count);
  }

  blend(on) {
    const { gl } = this;
    gl[on ? 'enable' : 'disable'](gl.BLEND);
    gl.depthMask(!on);
  }

  /** Returns the colour of a pixel. Coordinates start in the upper left corner. */
  pixel(x, y) {
    const { gl } = this;
    const out = new Uint8Array(4);
    gl.readPixels(x, this.canvas.height - 1 - y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out);
    return [...out.subarray(0, 3)];
  }
}

/** Returns whether there is no graphics processor, so that smooth edges would be too slow. */
function drawsSlowly() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const known = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = known ? gl.getParameter(known.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** Compiles a graphics program. Returns the program and the locations of its inputs. */
function program(gl, corners, paint) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, paint]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
    throw new Unreadable(`The graphics of this browser refuse to draw: ${gl.getProgramInfoLog(made)}`);
  }
  // Looking up the locations for every picture would take longer than setting the values.
  const places = {};
  for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(made, i);
    places[name] = gl.getUniformLocation(made, name);
  }
  return { made, places };
}

function buffer(gl, numbers) {
  const made = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, made);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
  return made;
}

function attribute(gl, from, place, size, stride, offset, divisor) {
  gl.bindBuffer(gl.ARRAY_BUFFER, from);
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, offset);
  gl.vertexAttribDivisor(place, divisor);
}
