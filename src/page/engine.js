// The WebAssembly module with strings and bytes instead of addresses.

/** Decompresses the bytes of a stream of the given format. */
async function decompressed(bytes, format, limit = Infinity) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format)).getReader();
  const chunks = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > limit) throw new Error(`more than ${limit} bytes`);
    chunks.push(value);
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) { all.set(chunk, at); at += chunk.length; }
  return all;
}

async function compressed(bytes, format) {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream(format));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

function toBase64(bytes) {
  let raw = '';
  for (let i = 0; i < bytes.length; i += 0x8000) raw += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(raw);
}

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** The bytes of the first part of the module. */
function inflated() {
  const { textContent, dataset } = document.getElementById('core');
  const { memory, inflate } = new WebAssembly.Instance(new WebAssembly.Module(fromBase64(INFLATE))).exports;
  const [length, size] = [textContent.length, Number(dataset.size)];
  const from = memory.buffer.byteLength;
  memory.grow(Math.ceil((length + size) / 65_536));
  encoder.encodeInto(textContent, new Uint8Array(memory.buffer, from, length));
  inflate(from, length, from + length, size);
  return new Uint8Array(memory.buffer, from + length, size);
}

/** The rest of the module as the page holds it. */
function packedRest() {
  const rest = document.getElementById('rest');
  if (!rest) throw new WebAssembly.RuntimeError('the page is still being read');
  return { text: rest.textContent, length: Number(rest.dataset.length) };
}

/** The bytes of the rest of the module. The inverse of `base94` in inline.mjs. */
function unpacked({ text, length }) {
  const bytes = new Uint8Array(length);
  const digit = (code) => (code === 126 ? 28 : code - 32);
  for (let at = 0, from = 0, bits = 0, count = 0; at < length; from += 2) {
    const number = digit(text.charCodeAt(from)) * 94 + digit(text.charCodeAt(from + 1));
    bits |= number << count;
    for (count += (number & 8191) < 644 ? 14 : 13; count >= 8 && at < length; at += 1) {
      bytes[at] = bits;
      bits >>= 8;
      count -= 8;
    }
  }
  return fzstd.decompress(bytes);
}

/** A message of the engine, as opposed to a failure of the module. */
class Refusal extends Error {}

class Engine {
  static BODY = 10;
  static COLLISION = 21;

  /** The parts of the module: `core` is enough for clicks in the empty room, `rest` is the other functions. */
  static core = null;
  static rest = null;

  static async create() {
    const engine = new Engine();
    // A function of the rest is at its place in the table once the rest is there.
    const place = (index) => (...args) => { engine.complete(); return engine.x['%table'].get(index)(...args); };
    const placeholder = new Proxy({}, { get: (_, index) => place(Number(index)) });
    engine.x = new WebAssembly.Instance(Engine.core, { placeholder }).exports;
    /** The time at which the rest was there, ms. */
    engine.whole = null;
    if (Engine.rest) engine.complete();
    return engine;
  }

  /** Adds the rest of the functions. */
  complete() {
    if (this.whole) return;
    Engine.rest ??= new WebAssembly.Module(unpacked(packedRest()));
    new WebAssembly.Instance(Engine.rest, { primary: this.x });
    this.whole = performance.now();
  }

  give(data) {
    const bytes = typeof data === 'string' ? encoder.encode(data) : data;
    const at = this.x.input(bytes.length);
    new Uint8Array(this.x.memory.buffer, at, bytes.length).set(bytes);
  }

  bytes() {
    return new Uint8Array(this.x.memory.buffer, this.x.output(), this.x.output_length()).slice();
  }

  text() { return decoder.decode(this.bytes()); }

  /** The text of a function that returns 0, or its message as an error. */
  ask(code) {
    if (code === 1) throw new Refusal(this.text());
    return this.text();
  }

  file(code) {
    if (code === 1) throw new Refusal(this.text());
    return this.bytes();
  }

  numbers(count, width) { return new Float64Array(this.x.memory.buffer, this.x.column_numbers(), count * width); }

  load(which, name, scene, lines = '') { this.give(`${name}\n${lines}\0${scene}`); this.ask(this.x.load(which)); }
  setLines(which, lines) { this.give(lines); this.ask(this.x.set_lines(which)); }
  status(which) { return JSON.parse(this.ask(this.x.status(which))); }
  event(which, line, now) { this.give(line); this.ask(this.x.event(which, now ? 1 : 0)); }
  throwBody(which, name, x, y, vx, vy, now) {
    this.give(name);
    return this.ask(this.x.throw_body(which, x, y, vx, vy, now ? 1 : 0));
  }
  set(which, key, value) { this.give(`${key}\n${value}`); this.ask(this.x.set(which)); }
  scene(which) { return this.ask(this.x.scene(which)); }
  lines(which) { return this.ask(this.x.lines(which)); }
  bodies(which, offset, key) { return this.numbers(this.x.bodies(which, offset, key), Engine.BODY); }
  isMadeByEvent(which, name) { this.give(name); return this.x.is_made_by_event(which) === 1; }
  names(which) { return JSON.parse(this.ask(this.x.names(which))); }
  collisions(which) { return this.numbers(this.x.collisions(which), Engine.COLLISION); }
  picture(format, step, options) { this.give(`${format}\n${step}\n${options}`); return this.file(this.x.picture()); }
  film(bytes) { this.give(bytes); return JSON.parse(this.ask(this.x.film_open())); }
}

/** One job of the worker: compiles a part of the module, draws a picture of a recording, or writes a table of it. */
async function work(job) {
  if (job.rest) return WebAssembly.compile(unpacked(job.rest));
  [Engine.core, Engine.rest] = job.modules;
  const engine = await Engine.create();
  engine.film(job.recording);
  return job.format === 'csv' ? engine.file(engine.x.csv(job.table)) : engine.picture(job.format, job.step, job.options);
}

if (typeof document === 'undefined') {
  onmessage = async ({ data }) => {
    try {
      postMessage({ result: await work(data) });
    } catch (error) {
      postMessage({ error: String(error.message ?? error) });
    }
  };
}
