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

/** Four bytes as five of 85 ASCII characters: '#' to 'w', with 'x' for '<'. A sixteenth shorter than base64. */
function base85(bytes) {
  const padded = Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3)]);
  const characters = Buffer.alloc((padded.length / 4) * 5);
  for (let at = 0, to = 0; at < padded.length; at += 4, to += 5) {
    let number = padded.readUInt32BE(at);
    for (let digit = 4; digit >= 0; digit -= 1, number = Math.floor(number / 85)) {
      const code = 35 + (number % 85);
      characters[to + digit] = code === 60 ? 120 : code;
    }
  }
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
  CORE: base85(core),
  SCRIPT: script,
  ARRIVED: arrived,
  RESTLENGTH: rest.length,
  REST: base85(rest),
};
const html = read(`${folder}/page.html`).replace(/@([A-Z]+)@/g, (_, name) => parts[name]);
writeFileSync(output, html);
console.log(`${output}: ${Buffer.byteLength(html)} bytes`);
