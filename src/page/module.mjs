// A WebAssembly module as a list of sections, for the scripts that change the data of one.

export const [MEMORY, DATA, DATA_COUNT] = [5, 11, 12];

/** Reads the number of variable length at `at`, and returns it with the place after it. */
export function number(bytes, at) {
  let [value, shift] = [0, 0];
  for (;;) {
    const byte = bytes[at];
    at += 1;
    value += (byte & 127) * 2 ** shift;
    shift += 7;
    if (byte < 128) return [value, at];
  }
}

/** The bytes of a number of variable length. */
export function encoded(value) {
  const bytes = [];
  for (; value > 127; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
  return [...bytes, value];
}

/** A segment of data for an address: `i32.const`, a number that repeats its sign in the highest bit, `end`. */
function segment([address, content]) {
  const constant = encoded(address);
  if (constant.at(-1) & 64) constant.push(constant.pop() | 128, 0);
  return Buffer.concat([Buffer.from([0, 0x41, ...constant, 0x0b, ...encoded(content.length)]), content]);
}

export class Module {
  constructor(bytes) {
    this.header = bytes.subarray(0, 8);
    this.sections = [];
    for (let at = 8; at < bytes.length;) {
      const [length, start] = number(bytes, at + 1);
      this.sections.push({ id: bytes[at], content: bytes.subarray(start, start + length) });
      at = start + length;
    }
  }

  /** The content of the section of a kind. */
  section(id) { return this.sections.find((section) => section.id === id)?.content; }

  /** The data: pairs of an address in the memory and the bytes that are there. */
  data() {
    const content = this.section(DATA);
    const segments = [];
    let [count, at] = number(content, 0);
    for (; count > 0; count -= 1) {
      let [kind, address, length] = [];
      [kind, at] = number(content, at);
      if (kind !== 0 || content[at] !== 0x41) throw new Error('expected active segments at constant addresses');
      [address, at] = number(content, at + 1);
      [length, at] = number(content, at + 1);
      segments.push([address, content.subarray(at, at + length)]);
      at += length;
    }
    return segments;
  }

  /** Replaces the data, or adds data to a module without any. */
  setData(segments) {
    this.sections = this.sections.filter(({ id }) => id !== DATA && id !== DATA_COUNT);
    const content = Buffer.concat([Buffer.from(encoded(segments.length)), ...segments.map(segment)]);
    // It comes after the code, before sections of other tools.
    const code = this.sections.findIndex(({ id }) => id === 10);
    this.sections.splice(code + 1, 0, { id: DATA, content });
  }

  bytes() {
    const sections = this.sections.flatMap(({ id, content }) => [Buffer.from([id, ...encoded(content.length)]), content]);
    return Buffer.concat([this.header, ...sections]);
  }
}
