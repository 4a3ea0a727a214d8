// Draws one world on a canvas: boxes, overlays, cursor.

/** Colours as CSS, made once each: there are as many as bodies only if they are coloured by speed. */
const cached = (make) => {
  const known = new Map();
  return (key) => {
    let made = known.get(key);
    if (made === undefined) known.set(key, (made = make(key)));
    return made;
  };
};
const css = cached((color) => `#${color.toString(16).padStart(6, '0')}`);
/** The colour of a name on a box, as in pictures: dark grey, else white, else black, with a contrast of 4.5 (WCAG 2). */
const inkOn = cached((color) => {
  const linear = (c) => (c <= 10 ? c / 3294.6 : ((c / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = 0.2126 * linear(color >> 16) + 0.7152 * linear((color >> 8) & 255) + 0.0722 * linear(color & 255);
  return luminance > 0.2505 ? '#1f2328' : luminance < 0.1833 ? '#ffffff' : '#000000';
});
const mix = (color, to, part) => {
  const channel = (shift) => Math.round(((color >> shift) & 255) * (1 - part) + to * part) << shift;
  return css(channel(16) | channel(8) | channel(0));
};
const EDGES = { light: cached((color) => mix(color, 0, 0.35)), dark: cached((color) => mix(color, 255, 0.35)) };

const INKS = {
  light: { page: '#eef1f5', paper: '#ffffff', wall: '#c9d0da', edge: '#8b96a5', grid: '#e6eaf0', ink: '#1c2430', normal: '#d6006c', impulse: '#8a5a00', momentum: '#6a3fc8', ghost: '#0b62d6' },
  dark: { page: '#0e1218', paper: '#161b23', wall: '#39424f', edge: '#66727f', grid: '#242b35', ink: '#e8edf4', normal: '#ff5fa8', impulse: '#ffc247', momentum: '#b79bff', ghost: '#6db0ff' },
};

/**
 * Metres of an arrow per unit of vectors of this kind: a quarter in a world 9 m high. If the longest arrow would then be
 * invisible at first, or at any time longer than half of the world, it is a power of two of that from there on, which
 * `reach` keeps.
 */
function arrowScale(reach, kind, longest, size) {
  const side = Math.min(...size);
  if (!Number.isFinite(longest)) return side / 36;
  if (!reach[kind]) {
    reach[kind] = side / 36;
    while (longest && longest * reach[kind] < side / 64) reach[kind] *= 2;
  }
  while (longest * reach[kind] > side / 2) reach[kind] /= 2;
  return reach[kind];
}

class Stage {
  /** From this number of bodies on, arrows and trails are one pixel wide: browsers need a tenth of the time. */
  static CROWD = 120;

  constructor(canvas) {
    this.canvas = canvas;
    this.size = [16, 9];
    this.trails = new Map();
    this.flashes = [];
    this.bodies = new Float64Array(0);
    this.names = [];
  }

  /** Fits the world, with a border for the walls, into the canvas. */
  fit() {
    this.pen ??= this.canvas.getContext('2d', { alpha: false });
    const { canvas, size: [width, height] } = this;
    const ratio = Math.min(globalThis.devicePixelRatio || 1, 2);
    const box = canvas.getBoundingClientRect();
    const pixels = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
    if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) [canvas.width, canvas.height] = pixels;
    // Lines and names grow with the room: a projector shows it to the last row.
    this.ratio = ratio * Math.max(1, Math.min(2, canvas.height / ratio / 700));
    const border = 12 * ratio;
    this.scale = Math.max(1e-9, Math.min((canvas.width - 2 * border) / width, (canvas.height - 2 * border) / height));
    this.left = (canvas.width - width * this.scale) / 2;
    this.top = (canvas.height - height * this.scale) / 2;
    this.border = border;
    /** The distance of the lines of the grid, m. */
    this.grid = 1;
    while (this.grid * this.scale < 24) this.grid *= this.grid.toString().startsWith('2') ? 2.5 : 2;
  }

  /** The point of the world at a point of the page. */
  point(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = (event.clientX - box.left) * (this.canvas.width / box.width);
    const y = (event.clientY - box.top) * (this.canvas.height / box.height);
    return [(x - this.left) / this.scale, (y - this.top) / this.scale];
  }

  /** The point of the page, in CSS pixels, at a point of the world. */
  place([x, y]) {
    const box = this.canvas.getBoundingClientRect();
    return [
      box.left + (this.left + x * this.scale) * (box.width / this.canvas.width),
      box.top + (this.top + y * this.scale) * (box.height / this.canvas.height),
    ];
  }

  /** Forgets what belongs to another session, or another time of this one. */
  clear() {
    this.trails.clear();
    this.flashes = [];
    this.key = null;
  }

  /**
   * The index of the body created last that covers a point, or -1; an infinite mass only if `isGripped`. A body reaches
   * at least `least` CSS pixels from its centre.
   */
  bodyAt([x, y], isGripped, least) {
    const b = this.bodies;
    const reach = (least / this.scale) * (this.canvas.width / this.canvas.getBoundingClientRect().width);
    const covers = (at, length, z) => Math.abs(z - at - length / 2) <= Math.max(length / 2, reach);
    for (let i = b.length - Engine.BODY; i >= 0; i -= Engine.BODY) {
      const inside = covers(b[i + 1], b[i + 3], x) && covers(b[i + 2], b[i + 4], y);
      if (inside && (b[i + 7] !== Infinity || (!b[i + 9] && isGripped(i)))) return i;
    }
    return -1;
  }

  /** Adds the present centres to the trails of one second. */
  extendTrails(rate) {
    const { bodies: b, trails } = this;
    const seen = new Set();
    const length = Math.max(2, Math.min(240, Math.round(rate)));
    for (let i = 0; i < b.length; i += Engine.BODY) {
      if (b[i + 9] || (b[i + 7] === Infinity && !b[i + 5] && !b[i + 6])) continue;
      seen.add(b[i]);
      let trail = trails.get(b[i]);
      if (!trail) trails.set(b[i], (trail = []));
      trail.push(b[i + 1] + b[i + 3] / 2, b[i + 2] + b[i + 4] / 2);
      if (trail.length > 2 * length) trail.splice(0, trail.length - 2 * length);
    }
    for (const id of trails.keys()) if (!seen.has(id)) trails.delete(id);
  }

  /** Remembers the collisions of a step for a few frames. */
  flash(collisions, frames) {
    for (let i = 0; i < collisions.length; i += Engine.COLLISION) {
      this.flashes.push({ frames, c: collisions.slice(i, i + Engine.COLLISION) });
    }
    if (this.flashes.length > 400) this.flashes.splice(0, this.flashes.length - 400);
  }

  draw(view) {
    const { pen, bodies: b, scale: k, left, top, size: [width, height], ratio } = this;
    const ink = INKS[view.theme];
    const X = (x) => left + x * k;
    const Y = (y) => top + y * k;
    // Without walls the world has no border: all that the canvas shows is its paper.
    pen.fillStyle = view.walls ? ink.page : ink.paper;
    pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
    if (view.walls) {
      const border = this.border - ratio;
      pen.fillStyle = ink.wall;
      pen.fillRect(left - border, top - border, width * k + 2 * border, height * k + 2 * border);
      pen.fillStyle = ink.paper;
      pen.fillRect(left, top, width * k, height * k);
    }
    if (view.show.has('grid')) this.drawGrid(ink);
    if (view.walls) {
      pen.strokeStyle = ink.edge;
      pen.lineWidth = ratio;
      pen.strokeRect(left - ratio / 2, top - ratio / 2, width * k + ratio, height * k + ratio);
    }
    if (view.show.has('trail')) this.drawTrails(EDGES[view.theme], X, Y);
    this.drawBoxes(EDGES[view.theme]);
    if (view.show.has('velocity')) this.arrows(view, ink.ink, 'velocity', (i) => [b[i + 5], b[i + 6]]);
    if (view.show.has('momentum')) {
      // Beside the velocity, which has the same direction.
      const beside = view.show.has('velocity') ? 7 * ratio : 0;
      this.arrows(view, ink.momentum, 'momentum', (i) => (b[i + 7] === Infinity ? [0, 0] : [b[i + 5] * b[i + 7], b[i + 6] * b[i + 7]]), beside);
    }
    if (view.show.has('name')) this.drawNames(view.show.has('velocity') || view.show.has('momentum') ? 0.3 : 0.5);
    this.drawFlashes(view, ink, X, Y);
    if (view.show.has('centre')) this.drawCentre(ink, X, Y);
    for (const mark of view.marks) this.drawMark(mark, ink, X, Y);
  }

  drawBoxes(edge) {
    const { pen, bodies: b, scale: k, left, top, ratio } = this;
    const isCrowd = b.length >= Stage.CROWD * Engine.BODY;
    const outline = Math.max(1, Math.min(2 * ratio, k * 0.04));
    // Rectangles of whole pixels are filled without smoothing.
    const [snap, border] = isCrowd ? [Math.round, Math.round(outline)] : [(x) => x, outline];
    // Many small outlines are only noise.
    const small = (b.length > 2000 * Engine.BODY ? 16 : 4) * outline;
    for (const group of this.groups(isCrowd)) {
      const insides = [];
      pen.fillStyle = edge(b[group[0] + 8]);
      for (const i of group) {
        const x = snap(left + b[i + 1] * k);
        const y = snap(top + b[i + 2] * k);
        const w = Math.max(snap(left + (b[i + 1] + b[i + 3]) * k) - x, 1);
        const h = Math.max(snap(top + (b[i + 2] + b[i + 4]) * k) - y, 1);
        if (w > small && h > small) {
          pen.fillRect(x, y, w, h);
          insides.push(x + border, y + border, w - 2 * border, h - 2 * border);
        } else insides.push(x, y, w, h);
      }
      pen.fillStyle = css(b[group[0] + 8]);
      for (let at = 0; at < insides.length; at += 4) pen.fillRect(insides[at], insides[at + 1], insides[at + 2], insides[at + 3]);
      for (const i of group) if (b[i + 7] === Infinity) this.hatch(left + b[i + 1] * k, top + b[i + 2] * k, b[i + 3] * k, b[i + 4] * k);
    }
  }

  /** The bodies that are drawn, in their order; those of a crowd by colour, because a change of colour takes time. */
  groups(isCrowd) {
    const b = this.bodies;
    const groups = new Map();
    for (let i = 0; i < b.length; i += Engine.BODY) {
      if (b[i + 9]) continue;
      const key = isCrowd ? b[i + 8] : i;
      const group = groups.get(key);
      if (group) group.push(i);
      else groups.set(key, [i]);
    }
    return groups.values();
  }

  drawGrid(ink) {
    const { pen, scale: k, left, top, size: [width, height] } = this;
    const step = this.grid;
    pen.strokeStyle = ink.grid;
    pen.lineWidth = this.ratio;
    pen.beginPath();
    for (let x = step; x < width; x += step) { pen.moveTo(left + x * k, top); pen.lineTo(left + x * k, top + height * k); }
    for (let y = step; y < height; y += step) { pen.moveTo(left, top + y * k); pen.lineTo(left + width * k, top + y * k); }
    pen.stroke();
  }

  hatch(x, y, w, h) {
    const { pen, ratio } = this;
    const gap = 8 * ratio;
    if (w <= 8 || h <= 8 || (w + h) / gap > 400) return;
    pen.save();
    pen.beginPath();
    pen.rect(x, y, w, h);
    pen.clip();
    pen.strokeStyle = 'rgb(0 0 0 / .22)';
    pen.lineWidth = ratio;
    pen.beginPath();
    for (let s = gap; s < w + h; s += gap) { pen.moveTo(x + s, y); pen.lineTo(x + s - h, y + h); }
    pen.stroke();
    pen.restore();
  }

  drawTrails(edge, X, Y) {
    const { pen, bodies: b, ratio } = this;
    const isCrowd = b.length >= Stage.CROWD * Engine.BODY;
    const stride = isCrowd ? 6 : 4;
    pen.lineWidth = isCrowd ? 1 : 2 * ratio;
    pen.globalAlpha = 0.45;
    for (let i = 0; i < b.length; i += Engine.BODY) {
      const trail = this.trails.get(b[i]);
      if (!trail) continue;
      pen.strokeStyle = edge(b[i + 8]);
      pen.beginPath();
      pen.moveTo(X(trail[0]), Y(trail[1]));
      for (let j = stride; j < trail.length; j += stride) pen.lineTo(X(trail[j]), Y(trail[j + 1]));
      pen.lineTo(X(trail.at(-2)), Y(trail.at(-1)));
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  /**
   * Arrows from the centres of the bodies, or `beside` pixels to the right of them as seen along the arrow; `of` gives a
   * vector of a kind.
   */
  arrows(view, color, kind, of, beside = 0) {
    const { pen, bodies: b, ratio, scale: k } = this;
    let longest = 0;
    for (let i = 0; i < b.length; i += Engine.BODY) {
      const [vx, vy] = of(i);
      longest = Math.max(longest, Math.sqrt(vx * vx + vy * vy));
    }
    const scale = arrowScale(view.reach, kind, longest, this.size);
    pen.beginPath();
    for (let i = 0; i < b.length; i += Engine.BODY) {
      if (b[i + 9]) continue;
      const [vx, vy] = of(i);
      const aside = beside / k / (Math.sqrt(vx * vx + vy * vy) || 1);
      this.arrow(b[i + 1] + b[i + 3] / 2 - vy * aside, b[i + 2] + b[i + 4] / 2 + vx * aside, vx * scale, vy * scale);
    }
    const isCrowd = b.length >= Stage.CROWD * Engine.BODY;
    if (!isCrowd) {
      // A margin keeps an arrow apart from a box of its colour.
      pen.strokeStyle = INKS[view.theme].paper;
      pen.lineWidth = 5 * ratio;
      pen.stroke();
    }
    pen.strokeStyle = color;
    pen.lineWidth = isCrowd ? 1 : 2.2 * ratio;
    pen.stroke();
  }

  /** Adds an arrow to the path; lengths in metres. */
  arrow(x, y, dx, dy) {
    const { pen, scale: k, left, top, ratio } = this;
    const length = Math.sqrt(dx * dx + dy * dy) * k;
    if (!(length > 5 * ratio)) return;
    const [x0, y0, x1, y1] = [left + x * k, top + y * k, left + (x + dx) * k, top + (y + dy) * k];
    const head = Math.min(8 * ratio, length / 2) / length;
    const [hx, hy] = [(x1 - x0) * head, (y1 - y0) * head];
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.moveTo(x1 - hx - hy / 2, y1 - hy + hx / 2);
    pen.lineTo(x1, y1);
    pen.lineTo(x1 - hx + hy / 2, y1 - hy - hx / 2);
  }

  /** `height` is the part of a box above its name: arrows begin at the centre. Below it, if the box moves up. */
  drawNames(height) {
    const { pen, bodies: b, names, scale: k, left, top, ratio } = this;
    // Changing the font costs more than writing, so names are written by size.
    const bySize = new Map();
    for (let i = 0, n = 0; i < b.length; i += Engine.BODY, n += 1) {
      const name = names[n]?.[0];
      if (b[i + 9] || !name) continue;
      const size = Math.round(Math.min(15 * ratio, b[i + 4] * k * (height < 0.5 ? 0.4 : 0.5), (b[i + 3] * k * 1.4) / name.length));
      if (size < 7 * ratio) continue;
      const list = bySize.get(size);
      if (list) list.push(i, n);
      else bySize.set(size, [i, n]);
    }
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    for (const [size, list] of bySize) {
      pen.font = `600 ${size}px system-ui, sans-serif`;
      for (let at = 0; at < list.length; at += 2) {
        const i = list[at];
        pen.fillStyle = inkOn(b[i + 8]);
        const y = b[i + 2] + b[i + 4] * (b[i + 6] < 0 ? 1 - height : height);
        pen.fillText(names[list[at + 1]][0], left + (b[i + 1] + b[i + 3] / 2) * k, top + y * k);
      }
    }
  }

  drawFlashes(view, ink, X, Y) {
    const { pen, ratio } = this;
    const shown = ['normal', 'penetration', 'impulse'].some((name) => view.show.has(name));
    const longest = this.flashes.reduce((longest, { c }) => Math.max(longest, Math.abs(c[5])), 0);
    const scale = view.show.has('impulse') ? arrowScale(view.reach, 'momentum', longest, this.size) : 0;
    const normal = Math.min(...this.size) / 13;
    const thick = this.bodies.length >= Stage.CROWD * Engine.BODY ? ratio / 3 : ratio;
    for (const flash of this.flashes) {
      if (!view.paused) flash.frames -= 1;
      if (!shown) continue;
      const c = flash.c;
      const edges = [0, 1].map((axis) => {
        const low = Math.max(c[11 + axis], c[15 + axis]);
        const high = Math.min(c[11 + axis] + c[13 + axis], c[15 + axis] + c[17 + axis]);
        return (low + high) / 2;
      });
      pen.lineWidth = 3 * thick;
      const arrow = (color, x, y) => {
        pen.strokeStyle = color;
        pen.beginPath();
        this.arrow(edges[0], edges[1], x, y);
        pen.stroke();
      };
      if (view.show.has('impulse')) arrow(ink.impulse, c[2] * c[5] * scale, c[3] * c[5] * scale);
      if (view.show.has('normal')) arrow(ink.normal, c[2] * normal, c[3] * normal);
      if (view.show.has('penetration') && (c[9] || c[10])) arrow(ink.ghost, c[9], c[10]);
      pen.fillStyle = ink.normal;
      pen.beginPath();
      pen.arc(X(edges[0]), Y(edges[1]), 4 * thick, 0, 7);
      pen.fill();
    }
    this.flashes = this.flashes.filter((flash) => flash.frames > 0);
  }

  drawCentre(ink, X, Y) {
    const { pen, bodies: b, ratio } = this;
    let [mass, x, y] = [0, 0, 0];
    for (let i = 0; i < b.length; i += Engine.BODY) {
      const m = b[i + 7];
      if (m === Infinity) continue;
      mass += m;
      x += m * (b[i + 1] + b[i + 3] / 2);
      y += m * (b[i + 2] + b[i + 4] / 2);
    }
    if (!mass) return;
    const [cx, cy, r] = [X(x / mass), Y(y / mass), 9 * ratio];
    pen.lineWidth = 2 * ratio;
    pen.strokeStyle = ink.ink;
    pen.fillStyle = ink.paper;
    pen.beginPath();
    pen.arc(cx, cy, r, 0, 7);
    pen.fill();
    pen.stroke();
    pen.fillStyle = ink.ink;
    pen.beginPath();
    pen.moveTo(cx, cy); pen.arc(cx, cy, r, 0, Math.PI / 2);
    pen.moveTo(cx, cy); pen.arc(cx, cy, r, Math.PI, Math.PI * 1.5);
    pen.fill();
  }

  /** A ghost of a box with an arrow, the selected body, or the cursor of the keyboard. */
  drawMark(mark, ink, X, Y) {
    const { pen, scale: k, ratio } = this;
    pen.strokeStyle = ink.ghost;
    pen.lineWidth = 2.5 * ratio;
    // A margin keeps lines apart from a box of their colour.
    const stroke = () => {
      pen.save();
      pen.setLineDash([]);
      pen.strokeStyle = ink.paper;
      pen.lineWidth = 6 * ratio;
      pen.stroke();
      pen.restore();
      pen.stroke();
    };
    if (mark.kind === 'cursor') {
      const [x, y, r] = [X(mark.x), Y(mark.y), 12 * ratio];
      pen.beginPath();
      pen.arc(x, y, r / 2, 0, 7);
      pen.moveTo(x - r, y); pen.lineTo(x + r, y);
      pen.moveTo(x, y - r); pen.lineTo(x, y + r);
      stroke();
      return;
    }
    pen.setLineDash(mark.kind === 'ghost' ? [6 * ratio, 4 * ratio] : []);
    pen.beginPath();
    pen.rect(X(mark.x) - 2 * ratio, Y(mark.y) - 2 * ratio, mark.w * k + 4 * ratio, mark.h * k + 4 * ratio);
    stroke();
    pen.setLineDash([]);
    if (mark.v) {
      pen.beginPath();
      this.arrow(mark.x + mark.w / 2, mark.y + mark.h / 2, mark.v[0] * mark.scale, mark.v[1] * mark.scale);
      stroke();
      pen.font = `600 ${15 * ratio}px system-ui, sans-serif`;
      pen.textAlign = 'center';
      pen.textBaseline = 'bottom';
      pen.fillStyle = ink.ink;
      pen.fillText(mark.text, X(mark.x + mark.w / 2), Y(mark.y) - 6 * ratio);
    }
  }
}

/** Draws energy and momentum against time: kinetic above potential energy, both from 0, and the norm of the momentum. */
function drawStrip(canvas, samples, rate, step, theme, labels) {
  const ratio = Math.min(globalThis.devicePixelRatio || 1, 2);
  const box = canvas.getBoundingClientRect();
  [canvas.width, canvas.height] = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
  const pen = canvas.getContext('2d');
  const ink = INKS[theme];
  pen.fillStyle = ink.paper;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  const count = samples.length / 5;
  if (count < 2) return;
  let [least, top, momentum] = [Infinity, 0, 0];
  for (let i = 0; i < samples.length; i += 5) {
    least = Math.min(least, samples[i + 2]);
    momentum = Math.max(momentum, Math.hypot(samples[i + 3], samples[i + 4]));
  }
  for (let i = 0; i < samples.length; i += 5) top = Math.max(top, samples[i + 1] + samples[i + 2] - least);
  const last = Math.max(samples[samples.length - 5], 1);
  const X = (s) => (s / last) * canvas.width;
  // Above the curves is a line of text.
  const Y = (value, of) => canvas.height - (canvas.height - 18 * ratio) * (value / (of || 1));
  const area = (value, color) => {
    pen.fillStyle = color;
    pen.beginPath();
    pen.moveTo(0, canvas.height);
    for (let i = 0; i < samples.length; i += 5) pen.lineTo(X(samples[i]), Y(value(i), top));
    pen.lineTo(canvas.width, canvas.height);
    pen.fill();
  };
  area((i) => samples[i + 1] + samples[i + 2] - least, theme === 'dark' ? '#2f6fb5' : '#8fc1ee');
  area((i) => samples[i + 2] - least, theme === 'dark' ? '#a5752c' : '#f2c57c');
  pen.strokeStyle = ink.momentum;
  pen.lineWidth = 1.5 * ratio;
  pen.beginPath();
  for (let i = 0; i < samples.length; i += 5) pen.lineTo(X(samples[i]), Y(Math.hypot(samples[i + 3], samples[i + 4]), momentum));
  pen.stroke();
  // The largest values of both, and the last time.
  pen.font = `${11 * ratio}px system-ui, sans-serif`;
  pen.fillStyle = ink.ink;
  pen.textBaseline = 'top';
  const [peaks, time] = labels(top, momentum, last / rate);
  pen.fillText(peaks, 4 * ratio, 2 * ratio);
  pen.textAlign = 'right';
  pen.textBaseline = 'bottom';
  pen.fillText(time, canvas.width - 4 * ratio, canvas.height - 2 * ratio);
  pen.strokeStyle = ink.ink;
  pen.lineWidth = ratio;
  pen.beginPath();
  pen.moveTo(X(step), 0); pen.lineTo(X(step), canvas.height);
  pen.stroke();
}
