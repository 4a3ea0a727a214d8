// Puts style, scripts, texts and both parts of the compressed WebAssembly module into one HTML file, with a content
// security policy that allows nothing else: node inline.mjs SOURCES PARTS PAGE
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';

const [folder, modules, output] = process.argv.slice(2);
const read = (path) => readFileSync(path, 'utf8').trim();
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
// Browsers decompress gzip, but zstd is a fifth smaller: 250 kB of the page.
const zstd = ['LICENSE', 'umd/index.js'].map((name) => read(new URL(`node_modules/fzstd/${name}`, import.meta.url)));
const room = `const EMPTY_ROOM = ${JSON.stringify(`${read(`${folder}/room.toml`)}\n`)};`;
const scripts = ['engine.js', 'texts.js', 'canvas.js', 'page.js'].map((name) => read(`${folder}/${name}`));
const script = ["'use strict';", `/* fzstd: ${zstd[0]} */`, zstd[1], room, ...scripts].join('\n');
// The script runs before the module has been read.
const arrived = "dispatchEvent(new Event('core'));";
const style = read(`${folder}/page.css`);

/** Each 13 bits as two of 91 ASCII characters: '#' to '}', with '~' for '<'. A thirteenth shorter than base64. */
function base91(bytes) {
  const characters = Buffer.alloc(2 * Math.ceil((8 * bytes.length) / 13));
  const character = (digit) => (digit === 25 ? 126 : 35 + digit);
  let [bits, count, to] = [0, 0, 0];
  const put = (number) => {
    characters[to] = character(Math.floor(number / 91));
    characters[to + 1] = character(number % 91);
    to += 2;
  };
  for (const byte of bytes) {
    bits = (bits << 8) | byte;
    count += 8;
    if (count >= 13) {
      count -= 13;
      put(bits >> count);
      bits &= (1 << count) - 1;
    }
  }
  if (count > 0) put(bits << (13 - count));
  return characters.toString('latin1');
}

const [core, rest] = ['core', 'rest'].map((part) => readFileSync(`${modules}/${part}.zst`));
const parts = {
  POLICY: [
    "default-src 'none'", `script-src ${hash(script)} ${hash(arrived)} 'wasm-unsafe-eval'`, `style-src ${hash(style)}`,
    'img-src blob: data:', 'worker-src blob:', "base-uri 'none'", "form-action 'none'",
  ].join('; '),
  STYLE: style,
  CORELENGTH: core.length,
  CORE: base91(core),
  SCRIPT: script,
  ARRIVED: arrived,
  RESTLENGTH: rest.length,
  REST: base91(rest),
};
const html = read(`${folder}/page.html`).replace(/@([A-Z]+)@/g, (_, name) => parts[name]);
writeFileSync(output, html);
console.log(`${output}: ${Buffer.byteLength(html)} bytes`);
