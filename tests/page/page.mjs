// Tests of the live page in a browser: node page.mjs chromium|firefox PAGE REBOND REPOSITORY
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import puppeteer from 'puppeteer-core';

const [name, file, rebond, repository] = process.argv.slice(2);
const url = pathToFileURL(resolve(file)).href;
const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');
const folder = mkdtempSync(join(tmpdir(), 'rebond-page-'));
const isChromium = name === 'chromium';
/** The path of the first of these programs that is installed. */
const which = (...programs) => execFileSync('sh', ['-c', programs.map((program) => `command -v ${program}`).join(' || ')], { encoding: 'utf8' }).trim();
const browser = await puppeteer.launch(isChromium
  ? { executablePath: which('chromium', 'google-chrome'), args: ['--no-sandbox', '--disable-dev-shm-usage', '--disable-gpu'], protocolTimeout: 120_000 }
  : { browser: 'firefox', executablePath: which('firefox-esr', 'firefox'), protocolTimeout: 120_000 });

const requests = [];
let page;

/** Opens the page with this fragment and waits until it is ready. */
async function open(fragment = '', size = { width: 1280, height: 800 }) {
  await page?.close();
  page = await browser.newPage();
  page.setDefaultTimeout(30_000);
  await page.setViewport(size);
  // There is no network, not even for what a page could ask for.
  if (isChromium) await page.setOfflineMode(true);
  page.on('request', (request) => requests.push(request.url()));
  await page.evaluateOnNewDocument(() => {
    // Downloads are kept, and violations of the policy are counted.
    window.violations = [];
    window.blobs = new Map();
    document.addEventListener('securitypolicyviolation', (event) => window.violations.push(`${event.violatedDirective} ${event.blockedURI}`));
    window.addEventListener('error', (event) => window.violations.push(String(event.message)));
    const make = URL.createObjectURL;
    URL.createObjectURL = (blob) => { const made = make.call(URL, blob); window.blobs.set(made, blob); return made; };
    const click = HTMLAnchorElement.prototype.click;
    HTMLAnchorElement.prototype.click = function () {
      if (this.download) window.saved = { name: this.download, blob: window.blobs.get(this.href) };
      else click.call(this);
    };
  });
  await page.goto(url + fragment);
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes');
}

const run = (f, ...args) => page.evaluate(f, ...args);
const wait = (f, ...args) => page.waitForFunction(f, { polling: 50 }, ...args);
const lines = () => run(() => rebond.engine.lines(0));
const step = () => run(() => rebond.engine.x.step_now(0));
const settle = () => wait(() => !rebond.state.seeking && !rebond.state.busy);
const press = (id) => run((id) => document.getElementById(id).click(), id);
/** Names, positions and velocities of the bodies of finite mass, to the bit. */
const bodies = (which = 0) => run((which) => {
  const names = rebond.engine.names(which);
  const b = [...rebond.engine.bodies(which, 0, 0)];
  return names.map(([name], n) => [name, ...b.slice(n * 10 + 1, n * 10 + 8)]).filter((body) => Number.isFinite(body[7]) && body[7] !== null);
}, which);
const finite = async (which = 0) => (await bodies(which)).map(([name]) => name);
/** The point of the page at a point of the world. */
const place = (x, y, which = 0) => run((x, y, which) => rebond.stages[which].place([x, y]), x, y, which);
async function click(x, y) {
  await page.mouse.click(...await place(x, y));
  await settle();
}
async function drag(from, to) {
  await page.mouse.move(...await place(...from));
  await page.mouse.down();
  await page.mouse.move(...await place(...to), { steps: 4 });
  await page.mouse.up();
  await settle();
}
async function seek(to) {
  await run((to) => rebond.seek(to), to);
  await settle();
}
async function save(kind) {
  await run((kind) => { window.saved = null; document.querySelector(`[data-file="${kind}"]`).click(); }, kind);
  await wait(() => window.saved && !rebond.state.busy);
  const [saved, text] = await run(async () => {
    const bytes = new Uint8Array(await window.saved.blob.arrayBuffer());
    let raw = '';
    for (let i = 0; i < bytes.length; i += 30_000) raw += String.fromCharCode(...bytes.subarray(i, i + 30_000));
    return [window.saved.name, btoa(raw)];
  });
  const path = join(folder, saved);
  writeFileSync(path, Buffer.from(text, 'base64'));
  return path;
}
async function choose(name) {
  await run((name) => { const list = document.getElementById('scenes'); list.value = name; list.dispatchEvent(new Event('change')); }, name);
  await settle();
}
async function setWorld(id, value) {
  await run((id, value) => { const input = document.getElementById(id); input.value = value; input.dispatchEvent(new Event('change')); }, id, value);
  await settle();
}
const openPanel = (name) => run((name) => { if (rebond.state.panel !== name) document.querySelector(`[data-panel="${name}"]`).click(); }, name);
const value = (id) => run((id) => document.getElementById(id).value, id);
const text = (id) => run((id) => document.getElementById(id).textContent, id);
const isPlaying = () => run(() => rebond.state.playing);
async function openFile(path) {
  const input = await page.$('#open');
  await input.uploadFile(resolve(path));
}
const toast = () => run(() => (document.getElementById('toast').hidden ? '' : document.getElementById('toast-text').textContent));
const command = (...args) => execFileSync(rebond, args, { encoding: 'utf8', cwd: folder });
const same = (one, two) => assert.ok(readFileSync(one).equals(readFileSync(two)), `${one} differs from ${two}`);
async function accessible(what) {
  await run(axe);
  const found = await run(async () => {
    const { violations } = await axe.run(document, { resultTypes: ['violations'] });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
  });
  assert.deepEqual(found, [], what);
}

const tests = {
  async 'a click makes a box, and a click on a box deletes it and never makes one'() {
    await open();
    await click(4, 5);
    await click(8, 3);
    assert.deepEqual(await finite(), ['box 1', 'box 2']);
    await click(4.2, 5.2);
    assert.deepEqual(await finite(), ['box 2']);
    await click(8.3, 3.3);
    assert.deepEqual(await finite(), []);
    assert.equal(await step(), 0);
    await press('undo');
    await settle();
    assert.deepEqual(await finite(), ['box 2']);
  },

  async 'without the first line of the handout’s mouse handler a click on a box makes another one'() {
    const count = (guarded) => run((guarded) => {
      const canvas = document.createElement('div');
      document.body.append(canvas);
      const make = () => {
        const box = canvas.appendChild(document.createElement('div'));
        box.addEventListener('click', () => box.remove());
      };
      canvas.addEventListener('click', function (event) {
        if (guarded && this !== event.target) return;
        make();
      });
      make();
      canvas.firstChild.click();
      const left = canvas.childElementCount;
      canvas.remove();
      return left;
    }, guarded);
    assert.deepEqual([await count(true), await count(false)], [0, 1]);
  },

  async 'a box is thrown while the world runs: deleted and spawned with its name in one step'() {
    await open();
    await click(3, 2);
    await press('play');
    await wait(() => rebond.engine.x.step_now(0) > 3);
    const [, x, y, w, h] = (await bodies())[0];
    const from = await place(x + w / 2, y + h / 2);
    await page.mouse.move(...from);
    await page.mouse.down();
    // If the box has fallen on before the button was pressed, a new box is made instead.
    await page.mouse.move(from[0] + 60, from[1] - 20, { steps: 4 });
    await page.mouse.move(from[0] + 160, from[1] - 60, { steps: 4 });
    await page.mouse.up();
    await press('play');
    await settle();
    const text = await lines();
    const events = text.trim().split('\n').map((line) => JSON.parse(line));
    assert.ok(events.length >= 2, text);
    const last = events.at(-1);
    if (last.spawn) {
      const before = events.at(-2).delete;
      assert.deepEqual([before.name, before.step], [last.spawn.name, last.spawn.step], text);
    }
    assert.equal(await toast(), '');
  },

  async 'a box is moved while the world stands still, and keeps its velocity'() {
    await open('#scene=masses');
    const [body] = await bodies();
    const from = await place(body[1] + body[3] / 2, body[2] + body[4] / 2);
    const to = await place(body[1] + body[3] / 2 + 1, body[2] + body[4] / 2);
    await seek(10);
    const [now] = await bodies();
    const grip = await place(now[1] + now[3] / 2, now[2] + now[4] / 2);
    await page.mouse.move(...grip);
    await page.mouse.down();
    await page.mouse.move(grip[0] + to[0] - from[0], grip[1], { steps: 5 });
    await page.mouse.up();
    await settle();
    const moved = (await bodies()).find(([name]) => name === body[0]);
    assert.ok(Math.abs(moved[1] - now[1] - 1) < 0.1, `${moved} ${now}`);
    assert.equal(moved[5], now[5]);
  },

  async 'scrubbing shows the bits that playing showed'() {
    await open('#scene=pile');
    const shown = [];
    for (const at of [0, 31, 90]) { await seek(at); shown.push(await bodies()); }
    for (const [index, at] of [[2, 90], [0, 0], [1, 31]]) { await seek(at); assert.deepEqual(await bodies(), shown[index], `step ${at}`); }
    await press('back');
    await settle();
    assert.equal(await step(), 30);
    await press('forward');
    assert.equal(await step(), 31);
    assert.deepEqual(await bodies(), shown[1]);
  },

  async 'every file of a session is the one that the command makes'() {
    await open();
    await click(4, 3);
    await seek(20);
    await click(4.4, 7);
    await click(9, 6);
    await seek(70);
    const [mcap, scene, events] = [await save('mcap'), await save('toml'), await save('jsonl')];
    command('record', scene, '--events', events, '-o', 'native.mcap', '--force');
    same(mcap, join(folder, 'native.mcap'));
    assert.match(command('replay', mcap), /^same: 600 steps/);
    const look = ['--theme', 'light', '--show', 'velocity,name,clock', '--color-by', 'body'];
    for (const kind of ['png', 'svg', 'gif']) {
      const size = kind === 'gif' ? ['--size', '640x360'] : ['--size', '1280x720', '--at', '70'];
      command('render', mcap, '-o', `native.${kind}`, ...size, ...look, '--force');
      same(await save(kind), join(folder, `native.${kind}`));
    }
    for (const table of ['states', 'collisions']) {
      command('export', mcap, '-o', `native-${table}.csv`, '--table', table, '--force');
      same(await save(table), join(folder, `native-${table}.csv`));
    }
    const clicks = await save('clicks');
    command('record', clicks, '-o', 'clicks.mcap', '--force');
    assert.equal(command('export', 'clicks.mcap'), readFileSync(join(folder, 'native-states.csv'), 'utf8'));
  },

  async 'both solvers run side by side on the same clicks'() {
    await open('#scene=first-scene&both');
    await click(6, 2);
    await seek(100);
    await page.mouse.click(...await place(12, 3, 1));
    await settle();
    assert.deepEqual(await finite(0), await finite(1));
    assert.equal((await finite()).length, 4);
    assert.notDeepEqual(await bodies(0), await bodies(1));
    assert.equal(await run(() => rebond.engine.lines(0) === rebond.engine.lines(1)), true);
    // The other solver begins beside a session that is under way, and reaches its step.
    await page.keyboard.press('b');
    await settle();
    assert.equal(await run(() => document.getElementById('canvas-1').parentElement.hidden), true);
    await page.keyboard.press('b');
    await settle();
    assert.deepEqual([await step(), await run(() => rebond.engine.x.step_now(1))], [100, 100]);
    const [left, right] = await run(() => [0, 1].map((n) => document.getElementById(`caption-${n}`).textContent));
    assert.match(`${left} ${right}`, /event-driven handout/);
    await run(() => { document.getElementById('side').value = '1'; });
    const mcap = await save('mcap');
    assert.match(command('replay', mcap), /^same/);
    assert.match(command('info', mcap), /handout/);
  },

  async 'gravity, restitution, rate and solver run the session again'() {
    await open();
    await click(4, 3);
    await seek(60);
    for (const [id, value, key, expected] of [['set-g', '1.6', 'gravity', [0, 1.6]], ['set-e', '0.5', 'restitution', 0.5], ['set-rate', '3', 'rate', 120]]) {
      await run((id, value) => { const input = document.getElementById(id); input.value = value; input.dispatchEvent(new Event('change')); }, id, value);
      await settle();
      assert.deepEqual(await run((key) => rebond.engine.status(0)[key], key), expected);
    }
    assert.equal(await step(), 120);
    assert.deepEqual(await finite(), ['box 1']);
  },

  async 'the next collision is shown with both figures and its numbers'() {
    await open('#scene=figure-1');
    await press('next');
    await settle();
    await wait(() => ['figure-1', 'figure-2'].every((id) => document.getElementById(id).naturalWidth > 0));
    assert.match(await run(() => document.getElementById('collision-text').textContent), /collide at/);
    assert.equal(await run(() => document.querySelectorAll('#collision-numbers dd').length), 13);
  },

  async 'a recording plays, scrubs and gets its verdict'() {
    await open();
    await openFile(join(repository, 'recordings/click-session.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.match(await run(() => document.getElementById('verdict').textContent), /^same: \d+ steps/);
    await seek(300);
    const shown = await run(() => [...rebond.stages[0].bodies]);
    await run(() => document.getElementById('film-scene').click());
    await seek(300);
    assert.deepEqual(await run(() => [...rebond.stages[0].bodies]), shown);

    const bytes = readFileSync(join(repository, 'recordings/click-session.mcap'));
    bytes[bytes.length >> 1] ^= 1;
    writeFileSync(join(folder, 'damaged.mcap'), bytes);
    await openFile(join(folder, 'damaged.mcap'));
    await wait(() => rebond.state.film?.verdict || document.getElementById('verdict').className === 'bad' || !document.getElementById('toast').hidden);
    assert.match(await run(() => `${document.getElementById('verdict').textContent} ${document.getElementById('toast-text').textContent}`), /corrupt|damaged|checksum/i);
  },

  async 'a recording that diverges shows the step at which it does'() {
    await open();
    await openFile(join(repository, 'tests/page/diverged.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.match(await run(() => document.getElementById('verdict').textContent), /^diverged at step 2: body "c" x/);
    assert.equal(await run(() => document.getElementById('verdict').className), 'bad');
    await seek(0);
    assert.equal(await run(() => rebond.state.film.step), 0);
    await run(() => document.getElementById('film-step').click());
    assert.equal(await run(() => rebond.state.film.step), 2);
    assert.match(await run(() => document.getElementById('film-step').textContent), /2$/);

    // The button belongs to that recording alone.
    await openFile(join(repository, 'recordings/click-session.mcap'));
    await wait(() => rebond.state.film.name === 'click-session.mcap' && rebond.state.film.verdict);
    assert.equal(await run(() => document.getElementById('film-step').hidden), true);
  },

  async 'every recording of the repository replays the same in the browser'() {
    await open();
    for (const recording of readdirSync(join(repository, 'recordings')).filter((entry) => entry.endsWith('.mcap'))) {
      const verdict = await run(async (text) => {
        const { engine } = rebond;
        engine.film(fromBase64(text));
        engine.ask(engine.x.verdict_start());
        for (;;) {
          const verdict = JSON.parse(engine.ask(engine.x.verdict_advance(200)));
          if (verdict.final) return verdict.line;
          await new Promise((resolve) => { setTimeout(resolve); });
        }
      }, readFileSync(join(repository, 'recordings', recording)).toString('base64'));
      assert.match(verdict, /^same/, recording);
    }
  },

  async 'scenes, events and hostile files are opened or refused with a message'() {
    await open();
    writeFileSync(join(folder, 'two.toml'), 'title = "<img src=x onerror=alert(1)>"\n[run]\nsteps = 60\n[[spawn]]\nname = "<b>x</b>"\nat = [1, 1]\nsize = [2, 1]\nmass = 1\n');
    await openFile(join(folder, 'two.toml'));
    await wait(() => document.getElementById('title').textContent.startsWith('<img'));
    assert.equal(await run(() => document.querySelectorAll('#title *, #bodies b').length), 0);
    writeFileSync(join(folder, 'two.jsonl'), '{"click": {"step": 3, "at": [9, 5], "spawn": {"size": [1, 1], "mass": 2}}}\nnonsense\n');
    await openFile(join(folder, 'two.jsonl'));
    await wait(() => !document.getElementById('toast').hidden);
    assert.match(await toast(), /line 2/);
    await seek(5);
    assert.equal((await finite()).length, 2);
    for (const [entry, text, expected] of [['bad.mcap', 'no recording', /./], ['bad.toml', '[run]\nsteps = 3\n[wrld]\n', /line 3: unknown key/], ['bad.xyz', 'x', /none of/]]) {
      writeFileSync(join(folder, entry), text);
      await press('toast-close');
      await openFile(join(folder, entry));
      await wait(() => !document.getElementById('toast').hidden);
      assert.match(await toast(), expected);
    }
    assert.equal((await finite()).length, 2, 'the session is kept');
    await open(`#s=${'A'.repeat(300)}`);
    assert.match(await toast(), /link/i);
    await open(`#s=${'A'.repeat(250_000)}`);
    assert.match(await toast(), /link/i);
  },

  async 'the ten minutes of the guide go as it says, and each step ends with its picture'() {
    const guide = readFileSync(join(repository, 'src/guide/page.md'), 'utf8');
    const stored = (entry) => join(repository, 'snapshots/ten-minutes', entry);
    /** What is saved as this kind of file is the stored one. */
    const isStored = async (kind, entry) => same(await save(kind), stored(entry));
    /** Goes to a step, and compares the picture of it with the one of the guide. */
    const picture = async (entry, at) => {
      await seek(at);
      await isStored('png', `${entry}.png`);
      assert.ok(guide.includes(`snapshots/ten-minutes/${entry}.png`), `the guide shows ${entry}.png`);
    };
    /** Opens the session of the guide, from which the next step begins, because clicks have times of their own. */
    const openStored = async (entry) => {
      await openFile(stored(entry));
      await wait((entry) => rebond.state.status[0].name === entry, entry);
      await settle();
    };
    const show = async (...overlays) => {
      await openPanel('view');
      await run((overlays) => document.querySelectorAll('#overlays input').forEach((input) => { if (input.checked !== overlays.includes(input.value)) input.click(); }), overlays);
      assert.deepEqual(await run(() => [...rebond.view.show].sort()), overlays.sort());
    };
    const playTo = async (at) => {
      await page.keyboard.press(' ');
      await wait((at) => rebond.engine.x.step_now(0) > at, at);
      await page.keyboard.press(' ');
      await settle();
    };

    await open();
    // The room gets 64 px per metre at whole pixels, so that both browsers click at the same points.
    await run(() => Object.assign(document.getElementById('stages').style, { position: 'fixed', left: '8px', top: '56px', width: '1048px', height: '600px' }));
    await wait(() => rebond.stages[0].scale === 64);
    // 1: clicks make boxes.
    for (const x of [3, 8, 13]) await click(x, 2);
    assert.deepEqual(await finite(), ['box 1', 'box 2', 'box 3']);
    await isStored('clicks', '1.toml');
    await openStored('1.toml');
    await picture('1', 0);
    // 2: a click on a box deletes it.
    await click(8, 2);
    assert.deepEqual(await finite(), ['box 1', 'box 3']);
    await isStored('clicks', '2.toml');
    await openStored('2.toml');
    await picture('2', 0);
    // 3: they fall.
    await playTo(20);
    assert.ok((await bodies()).every(([, , y]) => y > 1.55), 'they fall');
    await picture('3', 60);
    // 4: a box is thrown while it moves.
    await page.keyboard.press(' ');
    const [, x, y, w, h] = (await bodies())[0];
    const grip = await place(x + w / 2, y + h / 2);
    await page.mouse.move(...grip);
    await page.mouse.down();
    await page.mouse.move(grip[0] + 60, grip[1] - 20, { steps: 4 });
    assert.ok(await run(() => rebond.state.held), 'while it is held, time stands still');
    await page.mouse.move(grip[0] + 160, grip[1] - 60, { steps: 4 });
    await page.mouse.up();
    await page.keyboard.press(' ');
    await settle();
    assert.notEqual(await lines(), '', 'an event of the drag');
    await press('undo');
    await seek(60);
    await run(() => rebond.engine.throwBody(0, 'box 1', 4.5, 4, 8, -6, true));
    await isStored('clicks', '4.toml');
    await openStored('4.toml');
    await picture('4', 90);
    // 5: time runs back and forward.
    const shown = await bodies();
    await picture('5', 45);
    await seek(90);
    assert.deepEqual(await bodies(), shown, 'the same states');
    await isStored('png', '4.png');
    // 6: the same clicks in other worlds.
    for (const [entry, id, value] of [['6-stick', 'set-e', '0'], ['6-bounce', 'set-e', '1'], ['6-moon', 'set-g', '1.6']]) {
      await openPanel('world');
      await setWorld(id, value);
      await isStored('clicks', `${entry}.toml`);
      await openStored(`${entry}.toml`);
      await picture(entry, 240);
    }
    await openStored('6-stick.toml');
    await seek(500);
    assert.ok((await bodies()).every(([, , y, , , , vy]) => Math.abs(y - 8) < 1e-9 && vy === 0), 'boxes stick');
    await openStored('6-bounce.toml');
    await seek(500);
    assert.ok((await bodies()).some(([, , , , , , vy]) => vy !== 0), 'they bounce for ever');

    // 7: momenta and centre of mass.
    await choose('masses');
    await show('velocity', 'momentum', 'centre', 'name', 'clock');
    await playTo(10);
    await picture('7', 150);
    // 8: the figures of the handout.
    await choose('figure-1');
    await show('velocity', 'normal', 'penetration', 'name', 'clock');
    await page.keyboard.press('n');
    await wait(() => rebond.state.panel === 'collision' && document.getElementById('figure-2').naturalWidth > 0);
    await picture('8', await step());
    // 9: both solvers.
    await choose('bullet-handout');
    await show('velocity', 'name', 'clock');
    await page.keyboard.press('b');
    await settle();
    await playTo(5);
    await seek(78);
    assert.notDeepEqual(await bodies(0), await bodies(1));
    await isStored('png', '9-handout.png');
    await run(() => { document.getElementById('side').value = '1'; });
    await isStored('toml', '9-event-driven.toml');
    await page.keyboard.press('b');
    await settle();
    await openStored('9-event-driven.toml');
    await picture('9-event-driven', 78);
    // 10: numbers, and slow motion between two steps.
    await choose('first-scene');
    await openPanel('data');
    await seek(100);
    const energy = await run(() => document.getElementById('energy').textContent);
    assert.ok(guide.includes(energy), `the guide has the numbers: ${energy}`);
    assert.ok(await run(() => document.querySelectorAll('#bodies tr').length === 2 && document.querySelectorAll('#collisions tr').length > 0), 'tables');
    await page.select('#speed', '0.1');
    await press('play');
    await wait(() => {
      const [now, at] = [rebond.engine.x.step_now(0), rebond.stages[0].bodies[4 * 10 + 1]];
      const isBetween = globalThis.before?.now === now && globalThis.before.at !== at;
      globalThis.before = { now, at };
      return isBetween;
    });
    await press('play');
    await picture('10', 100);
    // 11: the recording replays the same, in the terminal and on the page.
    const mcap = await save('mcap');
    assert.match(command('replay', mcap), /^same/);
    await openFile(mcap);
    await wait(() => rebond.state.film?.verdict);
    assert.match(await run(() => document.getElementById('verdict').textContent), /^same/);
    await picture('10', 100);
    const unused = readdirSync(stored('.')).filter((entry) => entry.endsWith('.png') && !guide.includes(`ten-minutes/${entry}`));
    assert.deepEqual(unused, [], 'the guide shows every picture');
  },

  async 'the longest arrow is visible and within the world, whatever the units, and changes its scale only then'() {
    await open();
    const lengths = (side, ...longest) => run((side, longest) => {
      const reach = {};
      return longest.map((speed) => arrowScale(reach, 'velocity', speed, [2 * side, side]) * (speed || 1) / side);
    }, side, longest);
    // A fall from rest, to 18 m/s and back to rest: one scale.
    assert.deepEqual(await lengths(9, 0, 0.18, 18, 0), [1 / 36, 0.18 / 36, 0.5, 1 / 36]);
    for (const [side, speed] of [[9e-6, 0.1], [1e6, 1e-9], [9, 1e-300], [9, 1e300], [1e-9, 1e9]]) {
      const [first, later] = await lengths(side, speed, speed * 1e6);
      assert.ok(first >= 1 / 64 && first <= 0.5, `${speed} m/s in ${side} m: ${first}`);
      assert.ok(later > 0.25 && later <= 0.5, `a million times faster: ${later}`);
    }
  },

  async 'a box has the size, mass, material and velocity of the panel'() {
    await open();
    const set = (id, value) => run((id, value) => { const input = document.getElementById(id); input.value = value; for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true })); }, id, value);
    for (const [id, value] of [['box-w', '2'], ['box-h', '0.5'], ['box-m', '3.5'], ['box-material', 'steel'], ['box-vx', '4'], ['box-vy', '-2.5']]) await set(id, value);
    await click(4, 5);
    const { spawn, at } = JSON.parse(await lines()).click;
    assert.deepEqual([spawn.size, spawn.mass, spawn.material, spawn.velocity], [[2, 0.5], 3.5, 'steel', [4, -2.5]]);
    const [body] = await bodies();
    assert.deepEqual(body.slice(3), [2, 0.5, 4, -2.5, 3.5]);
    assert.ok(Math.abs(body[1] + 1 - at[0]) < 1e-9 && Math.abs(body[2] + 0.25 - at[1]) < 1e-9, 'its centre is where the click was');
    // A drag from an empty place: an arrow of a metre is 2 m/s.
    const [from, to] = [await place(10, 3), await place(11, 3.5)];
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 4 });
    await page.mouse.up();
    await settle();
    const [, , , , , vx, vy] = (await bodies())[1];
    assert.ok(Math.abs(vx - 2) < 0.1 && Math.abs(vy - 1) < 0.1, `${vx}, ${vy} m/s`);
    await run(() => document.getElementById('box-fixed').click());
    await click(8, 5);
    assert.equal(JSON.parse((await lines()).trim().split('\n').at(-1)).click.spawn.mass, 'inf');
    await press('clear');
    await settle();
    assert.deepEqual([await lines(), await finite()], ['', []]);
  },

  async 'play, slider, restart and colours change what is shown, and not the session'() {
    await open('#scene=materials');
    const colors = () => run(() => { const b = rebond.stages[0].bodies; return Array.from({ length: b.length / 10 }, (_, n) => b[n * 10 + 8]); });
    const shown = [];
    for (const key of ['0', '1', '2']) {
      await run((key) => { const list = document.getElementById('colour'); list.value = key; list.dispatchEvent(new Event('change')); }, key);
      await run(() => { const slider = document.getElementById('scrub'); slider.value = 60; slider.dispatchEvent(new Event('input')); });
      await settle();
      assert.equal(await step(), 60);
      shown.push((await colors()).join());
    }
    assert.equal(new Set(shown).size, 3, `by body, material, speed: ${shown.join('\n')}`);
    const before = await bodies();
    await press('restart');
    await settle();
    assert.equal(await step(), 0);
    await press('play');
    await wait(() => rebond.engine.x.step_now(0) > 5);
    await press('play');
    const stopped = await step();
    await run(() => new Promise((resolve) => { setTimeout(resolve, 200); }));
    assert.equal(await step(), stopped, 'a pause is a pause');
    await seek(60);
    assert.deepEqual([await bodies(), await lines()], [before, '']);
  },

  async 'the text of the scene is edited, and a mistake is a message of rebond at its line'() {
    await open('#scene=first-scene');
    const edit = (from, to) => run((from, to) => {
      const editor = document.getElementById('editor');
      editor.value = editor.value.replace(from, to);
      document.getElementById('run-text').click();
    }, from, to);
    await edit('restitution.default = 0.8', 'restitution.defalt = 0.8');
    await wait(() => document.getElementById('editor-errors').textContent);
    assert.match(await run(() => document.getElementById('editor-errors').textContent), /^line 4: .*defalt/);
    assert.equal((await finite()).length, 2, 'the session is kept');
    await edit('restitution.defalt = 0.8', 'restitution.default = 0.25');
    await wait(() => rebond.engine.status(0).restitution === 0.25);
    assert.equal(await run(() => document.getElementById('editor-errors').textContent), '');
  },

  async 'a file that is dropped is opened, and a session that is too long for a link is offered as a file'() {
    await open();
    const drop = (name, text) => run((name, text) => {
      const data = new DataTransfer();
      data.items.add(new File([text], name));
      for (const type of ['dragenter', 'dragover', 'drop']) dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
    }, name, text);
    await drop('dropped.toml', '[run]\nsteps = 60\n[[spawn]]\nname = "c"\nat = [1, 1]\nsize = [2, 1]\nmass = 1\n');
    await wait(() => rebond.state.status[0].name === 'dropped.toml');
    assert.deepEqual(await finite(), ['c']);
    assert.equal(await run(() => document.getElementById('drop').hidden), true);
    // Numbers that do not compress.
    const many = Array.from({ length: 700 }, (_, n) => `{"click": {"step": 1, "at": [${(n * 0.618034) % 16}, ${(n * 0.754878) % 9}], "spawn": {"size": [0.01, 0.01], "mass": ${1 + ((n * 0.569840) % 1)}}}}`);
    await drop('many.jsonl', many.join('\n'));
    await wait(() => rebond.engine.lines(0).length > 10_000);
    await run(() => document.querySelector('[data-panel="files"]').click());
    await run(() => document.querySelector('[data-file="link"]').click());
    await wait(() => !document.getElementById('toast').hidden && !rebond.state.busy);
    assert.match(await toast(), /link would have \d{5} bytes. Save the scene with clicks/);
    assert.equal(await run(() => document.getElementById('link').value), '');
    assert.equal(await run(() => document.activeElement.dataset.file), 'clicks', 'the button of that file has the focus');
  },

  async 'a new scene has its own names, and undo returns to the one before with its clicks'() {
    await open();
    await click(4, 5);
    await click(8, 3);
    await choose('first-scene');
    const shown = () => run(() => rebond.stages[0].names.map(([name]) => name).filter((name) => !name.startsWith('wall')));
    assert.deepEqual(await shown(), ['ball', 'block']);
    await choose('masses');
    assert.deepEqual(await shown(), await finite());
    await seek(30);
    await press('undo');
    await press('undo');
    await settle();
    assert.deepEqual(await shown(), ['box 1', 'box 2']);
    assert.deepEqual(await run(() => [document.getElementById('scenes').value, document.title, document.getElementById('editor').value === rebond.engine.scene(0)]), ['', 'Empty room – rebond', true]);
    assert.equal((await lines()).trim().split('\n').length, 2);
    // What is written stays, and what would be lost is asked about.
    await run(() => { document.getElementById('editor').value = '# mine'; });
    await setWorld('set-e', '0.5');
    assert.equal(await run(() => document.getElementById('editor').value), '# mine');
    const isAsked = () => run(() => !dispatchEvent(new Event('beforeunload', { cancelable: true })));
    assert.equal(await isAsked(), true);
    await run(() => { document.getElementById('editor').value = rebond.engine.scene(0); });
    assert.equal(await isAsked(), true);
    await save('clicks');
    assert.equal(await isAsked(), false);
    await setWorld('set-g', '3');
    assert.equal(await isAsked(), true, 'a setting');
    await save('toml');
    assert.equal(await isAsked(), false);
    // Clicks made while a file is written are not in it.
    await run(async () => {
      window.saved = null;
      document.querySelector('[data-file="mcap"]').click();
      await rebond.click([12, 2]);
    });
    await wait(() => window.saved && !rebond.state.busy);
    assert.equal(await isAsked(), true, 'a click during saving');
  },

  async 'keys act on the world after a click on a control, and in a list'() {
    await open();
    await page.select('#scenes', 'figure-1');
    await page.focus('#scenes');
    // A letter goes to an entry of the list.
    await page.keyboard.press('z');
    assert.deepEqual(await run(() => [rebond.state.scene, rebond.state.panel]), ['figure-1', null]);
    await run(() => document.activeElement.blur());
    await page.keyboard.press('n');
    await settle();
    assert.deepEqual(await run(() => [rebond.state.scene, rebond.state.panel]), ['figure-1', 'collision']);
    for (const control of ['#scrub', '#forward', '[data-panel="data"]', '#theme']) {
      await page.click(control);
      await settle();
      const panel = await run(() => rebond.state.panel);
      await page.keyboard.press(' ');
      assert.deepEqual([await isPlaying(), await run(() => rebond.state.panel)], [true, panel], control);
      await page.keyboard.press(' ');
      assert.equal(await isPlaying(), false, control);
    }
    // From the keyboard, a button is still a button.
    const at = await step();
    await page.focus('#forward');
    await page.keyboard.press(' ');
    assert.deepEqual([await isPlaying(), await step()], [false, at + 1]);
  },

  async 'the events of a recording are in its files, its link and its scene'() {
    await open();
    await click(4, 3);
    await seek(50);
    await click(9, 6);
    const shown = await bodies();
    const mcap = await save('mcap');
    await openFile(mcap);
    await wait(() => rebond.state.film?.verdict);
    const states = command('export', mcap);
    const [scene, events, clicks] = [await save('toml'), await save('jsonl'), await save('clicks')];
    command('record', scene, '--events', events, '-o', 'again.mcap', '--force');
    assert.equal(command('export', 'again.mcap'), states);
    command('record', clicks, '-o', 'again.mcap', '--force');
    assert.equal(command('export', 'again.mcap'), states);
    await run(() => document.querySelector('[data-file="link"]').click());
    await wait(() => document.getElementById('link').value !== '');
    const link = await run(() => document.getElementById('link').value);
    await press('film-scene');
    await seek(50);
    assert.deepEqual(await bodies(), shown);
    await open(link.slice(link.indexOf('#')));
    await seek(50);
    assert.deepEqual(await bodies(), shown);
  },

  async 'a recording is not changed, and neither is the session behind it'() {
    await open('#scene=figure-1');
    await press('next');
    await settle();
    const before = await run(() => [rebond.engine.scene(0), rebond.engine.lines(0), rebond.engine.x.step_now(0)]);
    await openFile(join(repository, 'recordings/click-session.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.deepEqual(await run(() => [rebond.state.panel, document.getElementById('scenes').selectedOptions[0].text, document.title]), [null, 'A session of clicks', 'A session of clicks – rebond']);
    assert.deepEqual(await run(() => ['set-g', 'clear', 'next', 'undo'].map((id) => document.getElementById(id).disabled)), [true, true, true, true]);
    assert.match(await run(() => document.getElementById('world-help').textContent), /recording cannot be changed/);
    const world = await place(3, 3);
    for (const action of [() => page.keyboard.press('b'), () => page.keyboard.press('n'), () => page.keyboard.press('z'), () => page.mouse.click(...world)]) {
      await press('toast-close');
      await action();
      assert.match(await toast(), /recording cannot be changed/);
    }
    assert.equal(await run(() => rebond.state.both), false);
    await run(() => document.querySelector('[data-panel="files"]').click());
    await seek(5);
    assert.match(await run(() => document.getElementById('command').textContent), /click-session\.mcap -o click-session\.png --at 5 /);
    await press('film-close');
    assert.deepEqual(await run(() => [rebond.engine.scene(0), rebond.engine.lines(0), rebond.engine.x.step_now(0)]), before);
    assert.deepEqual(await run(() => [document.getElementById('scenes').value, document.getElementById('set-g').disabled]), ['figure-1', false]);
  },

  async 'a box of infinite mass that a click made is deleted and dragged, and a wall is not'() {
    await open('#scene=bullet-exact');
    await run(() => document.getElementById('box-fixed').click());
    const [x, y] = await run(() => { const b = rebond.stages[0].bodies; for (let i = 0; i < b.length; i += 10) if (!b[i + 9] && b[i + 7] === Infinity) return [b[i + 1] + b[i + 3] / 2, b[i + 2] + b[i + 4] / 2]; return null; });
    const count = () => run(() => rebond.stages[0].names.length);
    const before = await count();
    await click(3, 2);
    assert.equal(await count(), before + 1);
    const from = await place(3, 2);
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...await place(5, 2), { steps: 4 });
    await page.mouse.up();
    await settle();
    assert.equal(await count(), before + 1);
    await click(3, 2);
    assert.equal(await count(), before + 2);
    await click(5, 2);
    await click(3, 2);
    assert.equal(await count(), before);
    await click(x, y);
    assert.equal(await count(), before + 1, 'on a body of the scene, a click makes a box');
  },

  async 'World states the values of the world, keeps the other component, and is undone'() {
    await open();
    const output = (id) => run((id) => document.getElementById(id).nextElementSibling.value, id);
    assert.equal(await output('set-g'), '9.81');
    await click(4, 3);
    await setWorld('set-g', '1.6');
    assert.equal(await output('set-g'), '1.6');
    await press('undo');
    await settle();
    assert.deepEqual([await output('set-g'), await finite()], ['9.81', ['box 1']]);
    assert.equal(await run(() => rebond.engine.status(0).gravity[1]), 9.81);
    await press('undo');
    await settle();
    assert.deepEqual(await finite(), []);
    writeFileSync(join(folder, 'tilted.toml'), '[run]\nsteps = 60\n[world]\ngravity = [3.0, 50.0]\n[restitution]\ndefault = 0.33\n');
    await openFile(join(folder, 'tilted.toml'));
    await wait(() => rebond.state.status[0].name === 'tilted.toml');
    assert.deepEqual([await output('set-g'), await output('set-e')], ['(3, 50)', '0.33']);
    await setWorld('set-g', '1.6');
    assert.deepEqual(await run(() => rebond.engine.status(0).gravity), [3, 1.6]);
    // In both worlds, and for the solver.
    await page.keyboard.press('b');
    await settle();
    await setWorld('set-g', '2');
    await page.keyboard.press('z');
    await settle();
    assert.deepEqual(await run(() => [0, 1].map((which) => rebond.engine.status(which).gravity[1])), [1.6, 1.6]);
    assert.notEqual(...await run(() => [0, 1].map((which) => rebond.engine.status(which).solver)));
  },

  async 'a mass has a point or a comma, and one that is none is marked and named'() {
    await open();
    const mass = async (text) => {
      await run((text) => { const input = document.getElementById('box-m'); input.value = text; input.dispatchEvent(new Event('input')); }, text);
      return run(() => document.getElementById('box-m').getAttribute('aria-invalid'));
    };
    assert.equal(await mass('2,5'), 'false');
    await click(4, 3);
    assert.equal((await bodies())[0][7], 2.5);
    for (const text of ['', 'abc', '0.0005', '1e999', '-1']) {
      assert.equal(await mass(text), 'true', text);
      await click(8, 3);
      assert.match(await toast(), /^Mass: a number/);
    }
    assert.deepEqual(await finite(), ['box 1']);
    await run(() => { document.querySelector('[data-panel="box"]').click(); document.getElementById('box-m').focus(); });
    await page.keyboard.press('Escape');
    assert.deepEqual(await run(() => [rebond.state.panel, document.activeElement.dataset.panel]), [null, 'box']);
  },

  async 'lengths of the view are stated: the distance of the grid, the scale of arrows, the peaks of the energy'() {
    await open('#scene=first-scene&both', { width: 360, height: 640 });
    await run(() => document.querySelector('[data-panel="view"]').click());
    const label = (name) => run((name) => document.querySelector(`#overlays [value="${name}"]`).nextElementSibling.textContent, name);
    await run(() => document.querySelector('#overlays [value="grid"]').click());
    assert.equal(await label('grid'), `grid (${await run(() => rebond.stages[0].grid)} m)`);
    assert.equal(await label('grid'), 'grid (2 m)');
    const scale = await run(() => 1 / rebond.view.reach.velocity);
    assert.equal(await label('velocity'), `velocity (1 m = ${scale} m/s)`);
    await seek(60);
    await run(() => document.querySelector('[data-panel="data"]').click());
    assert.match(await run(() => TEXTS.en.peaks('1', '2')), /1 J, 2 kg·m\/s/);
    assert.match(await run(() => document.getElementById('legend').textContent), /kinetic.*potential.*momentum/);
  },

  async 'the numbers of a collision name the bodies as its figures do'() {
    await open('#scene=figure-1');
    await press('next');
    await settle();
    const numbers = await run(() => [...document.querySelectorAll('#collision-numbers dd')].map((dd) => dd.textContent));
    const c = (await bodies()).find(([name]) => name === 'c');
    const b = (await bodies()).find(([name]) => name === 'b');
    assert.deepEqual(numbers.slice(0, 2), ['c', 'b']);
    // The normal points to c.
    assert.equal(numbers[3], c[1] < b[1] ? '(−1, 0)' : '(1, 0)');
  },

  async 'a click outside of the room makes no box, and without a collision time stands where it was'() {
    await open();
    const [left, top] = await place(0, 4);
    await page.mouse.click(left - 40, top);
    await settle();
    assert.match(await toast(), /outside of the room/);
    assert.equal(await lines(), '');
    await press('next');
    await settle();
    await wait(() => /no collision/.test(document.getElementById('toast-text').textContent));
    assert.deepEqual(await run(() => [rebond.engine.x.step_now(0), rebond.engine.status(0).end, rebond.engine.status(0).recorded_steps]), [0, 0, 600]);
  },

  async 'a drag is let go by Escape, and its arrow is the one that the box gets'() {
    await open();
    await click(4, 5);
    const from = await place(4, 5);
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(from[0] + 100, from[1], { steps: 3 });
    await page.keyboard.press('z');
    assert.deepEqual(await finite(), ['box 1'], 'no undo while a box is held');
    await page.keyboard.press('Escape');
    assert.deepEqual(await run(() => [rebond.state.held, rebond.view.marks.length]), [false, 0]);
    await page.mouse.up();
    await settle();
    assert.equal((await lines()).trim().split('\n').length, 1);
    const [start, end] = [await place(8, 3), await place(10, 3)];
    await page.mouse.move(...start);
    await page.mouse.down();
    await page.mouse.move(...end, { steps: 3 });
    const { v, scale, text } = await run(() => rebond.view.marks[0]);
    assert.equal(text, `${Number(Math.hypot(...v).toPrecision(4))} m/s`);
    await page.mouse.up();
    await settle();
    const [, , , , , vx] = (await bodies())[1];
    assert.ok(Math.abs(v[0] - vx) < 0.1 && scale === await run(() => rebond.view.reach.velocity), `${v} ${vx} ${scale}`);
  },

  async 'files have names in any case, and a text that is none or has no event changes nothing'() {
    await open();
    await click(4, 5);
    const before = await lines();
    for (const [entry, bytes, expected] of [
      ['latin1.toml', Buffer.from('title = "Pi\xe8ce"\n', 'latin1'), /latin1\.toml is not UTF-8/],
      ['garbage.jsonl', Buffer.from('garbage\n'.repeat(50)), /line 1/],
    ]) {
      writeFileSync(join(folder, entry), bytes);
      await press('toast-close');
      await openFile(join(folder, entry));
      await wait(() => !document.getElementById('toast').hidden);
      assert.match(await toast(), expected);
      assert.equal(await lines(), before);
    }
    writeFileSync(join(folder, 'Big.TOML'), '[run]\nsteps = 1000000000\n');
    await openFile(join(folder, 'Big.TOML'));
    await wait(() => rebond.state.status[0].name === 'Big.TOML');
    // A recording that would take hours ends with its message, or with its session.
    const begin = () => run(() => document.querySelector('[data-file="mcap"]').click());
    await begin();
    await wait(() => /Working… [\d.]+ %/.test(document.getElementById('toast-text').textContent));
    await press('toast-close');
    await wait(() => /nothing is saved/.test(document.getElementById('toast-text').textContent));
    await begin();
    await wait(() => rebond.state.busy);
    await choose('first-scene');
    assert.match(await save('mcap'), /first-scene\.mcap$/);
  },

  async 'what happens is said, and the focus stays near'() {
    await open();
    const said = () => run(() => document.getElementById('said').textContent);
    await page.focus('#canvas-0');
    await page.keyboard.press('Enter');
    await settle();
    assert.equal(await said(), 'box 1 is made');
    await page.keyboard.press('.');
    assert.equal(await said(), '0.02 s, step 1');
    await page.keyboard.press(' ');
    assert.equal(await said(), 'runs');
    await page.keyboard.press(' ');
    assert.match(await said(), /s, step \d+$/);
    await click(3, 2);
    await page.focus('[data-panel="data"]');
    await page.keyboard.press('Enter');
    assert.equal(await run(() => document.activeElement.id), 'panel');
    for (const left of [1, 0]) {
      await page.focus('#bodies button');
      await page.keyboard.press('Delete');
      await settle();
      assert.match(await said(), /is deleted/);
      assert.equal(await run(() => document.activeElement.matches('#bodies button, .scroll')), true);
      assert.equal((await finite()).length, left);
    }
    await page.keyboard.press('Escape');
    assert.deepEqual(await run(() => [rebond.state.panel, document.activeElement.dataset.panel]), [null, 'data']);
    // Names have the contrast that WCAG 2 demands.
    const contrasts = await run(() => {
      const luminance = (color) => [16, 8, 0].map((shift) => ((color >> shift) & 255) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)).reduce((sum, c, at) => sum + c * [0.2126, 0.7152, 0.0722][at], 0) + 0.05;
      return [0x0072b2, 0x009e73, 0xd55e00, 0xe69f00, 0xcc79a7, 0x56b4e9, 0xf0e442, 0x777777, 0xffffff, 0].map((color) => {
        const two = [color, parseInt(inkOn(color).slice(1), 16)].map(luminance);
        return Math.max(...two) / Math.min(...two);
      });
    });
    assert.ok(contrasts.every((contrast) => contrast >= 4.5), contrasts.join());
  },

  async 'French numbers have a comma, and the language is kept'() {
    await open('#scene=first-scene');
    await press('language');
    await seek(100);
    await run(() => document.querySelector('[data-panel="data"]').click());
    assert.match(await run(() => document.getElementById('energy').textContent), /24,07 J.*\(6\u00a0; −4,745\)/);
    assert.equal(await run(() => document.getElementById('clock').value), '1,67 s');
    await open();
    assert.equal(await run(() => document.documentElement.lang), 'fr');
    await openFile(join(repository, 'tests/page/diverged.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.equal(await run(() => document.getElementById('film-step').textContent), 'Montrer le pas 2');
    await press('language');
    assert.equal(await run(() => document.getElementById('film-step').textContent), 'Show step 2');
    await run(() => localStorage.clear());
  },

  async 'French names: scenes, walls, boxes'() {
    await open('#scene=masses');
    await press('language');
    assert.deepEqual([await text('title'), await run(() => document.getElementById('scenes').selectedOptions[0].text)], Array(2).fill('Légère sur lourde, égales, lourde sur légère'));
    assert.deepEqual(await run(() => rebond.state.bundled.map(([name]) => name).filter((name) => !TITLES_FR[name])), []);
    await choose('');
    assert.equal(await text('title'), 'Pièce vide');
    await click(4, 8);
    assert.deepEqual(await finite(), ['boîte 1']);
    await press('next');
    await settle();
    assert.match(await text('collision-text'), /^boîte 1 et mur du bas se heurtent à 0,3\d+ s$/);
    await openPanel('data');
    assert.equal(await run(() => document.querySelector('#collisions tr').cells[2].textContent), 'mur du bas');
    await press('language');
    assert.deepEqual([await text('title'), await finite(), await run(() => document.querySelector('#collisions tr').cells[2].textContent)], ['Empty room', ['boîte 1'], 'wall-bottom']);
    await run(() => localStorage.clear());
  },

  async 'a box that is dropped on another one in the paused room deletes none'() {
    await open();
    await click(3, 3);
    await click(6, 3);
    await drag([6, 3], [3, 3]);
    assert.deepEqual(await finite(), ['box 1', 'box 2']);
    assert.ok((await bodies()).every(([, x, y]) => Math.abs(x - 2.5) < 0.1 && Math.abs(y - 2.5) < 0.1));
    await page.keyboard.down('Control');
    await page.keyboard.press('z');
    await page.keyboard.up('Control');
    await settle();
    assert.ok(Math.abs((await bodies())[1][1] - 5.5) < 0.1, 'Ctrl+Z undoes');
  },

  async 'settings that follow each other at once keep the time, and the run goes on'() {
    await open('#scene=pile');
    await seek(600);
    await openPanel('world');
    await page.focus('#set-g');
    for (let i = 0; i < 6; i += 1) await page.keyboard.press('ArrowRight');
    await settle();
    assert.deepEqual([await step(), await isPlaying()], [600, false]);
    await press('play');
    await run(() => {
      const slider = document.getElementById('set-g');
      for (let i = 0; i < 6; i += 1) { slider.stepDown(); slider.dispatchEvent(new Event('change')); }
    });
    await settle();
    assert.ok(await step() >= 600 && await isPlaying());
    await page.keyboard.press('b');
    await settle();
    assert.ok(await isPlaying(), 'B goes on, too');
    await press('play');
    assert.equal(await isPlaying(), false);
  },

  async 'a scene that is chosen while the world runs stands still'() {
    await open();
    await press('play');
    await choose('masses');
    assert.deepEqual([await isPlaying(), await run(() => document.getElementById('play').getAttribute('aria-label'))], [false, 'Play (Space)']);
  },

  async 'boxes that are only displaced have their shares and displacements'() {
    await open('#scene=overlapping-boxes');
    await press('next');
    await settle();
    assert.equal(await step(), 3);
    const numbers = await run(() => Object.fromEntries([...document.querySelectorAll('#collision-numbers dt')].map((dt) => [dt.textContent, dt.nextElementSibling.textContent])));
    assert.deepEqual([numbers['body c'], numbers['impulse j'], numbers['share N_c'], numbers['share N_b']], ['10 kg', '0 N·s', '0', '1']);
    assert.deepEqual([numbers['displacement of c'], numbers['displacement of b'], numbers.penetration], ['(0, 0) m', '(1, 0) m', '(−1, 0) m']);
    await wait(() => ['figure-1', 'figure-2'].every((id) => document.getElementById(id).naturalWidth > 0));
  },

  async 'the panels show the chosen world'() {
    await open('#scene=bounce-handout&both');
    const isShown = () => run(() => !document.getElementById('side-label').hidden);
    for (const [panel, expected] of [['box', false], ['data', true], ['files', true], ['data', true]]) {
      await openPanel(panel);
      assert.equal(await isShown(), expected, panel);
    }
    await seek(300);
    const left = await text('energy');
    await page.select('#side', '1');
    assert.notEqual(await text('energy'), left);
    const [[name, , y]] = await bodies(1);
    const shown = await run((name) => [...document.querySelectorAll('#bodies tr')].find((row) => row.cells[0].textContent === name).cells[3].textContent, name);
    assert.equal(shown, String(Number(y.toPrecision(4))));
    await openPanel('files');
    assert.match(await text('command'), /bounce-handout-2\.mcap -o bounce-handout-2\.png/);
    await page.select('#side', '0');
    assert.match(await text('command'), /bounce-handout\.mcap -o bounce-handout\.png/);
    writeFileSync(join(folder, 'it\'s mine.toml'), '[run]\nsteps = 60\n');
    await openFile(join(folder, 'it\'s mine.toml'));
    await wait(() => rebond.state.status[0].name.startsWith('it'));
    await openPanel('files');
    assert.ok((await text('command')).includes("render 'it'\\''s mine.mcap' -o 'it'\\''s mine.png'"), await text('command'));
  },

  async 'side by side stays with undo, recordings and links'() {
    await open('#scene=bounce-handout&both');
    const both = () => run(() => [rebond.state.both, !document.getElementById('canvas-1').parentElement.hidden]);
    await page.keyboard.press('b');
    await settle();
    assert.deepEqual(await both(), [false, false]);
    await page.keyboard.press('z');
    await settle();
    assert.deepEqual(await both(), [true, true]);
    await seek(20);
    await openFile(join(repository, 'recordings/click-session.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.deepEqual(await both(), [true, false]);
    await press('film-close');
    assert.deepEqual(await both(), [true, true]);
    assert.deepEqual([await step(), await run(() => rebond.engine.x.step_now(1))], [20, 20]);
    await openPanel('files');
    await run(() => document.querySelector('[data-file="link"]').click());
    await wait(() => document.getElementById('link').value !== '');
    const link = await value('link');
    // The link of another session is not shown.
    await click(3, 2);
    assert.equal(await run(() => document.getElementById('link-label').hidden), true);
    await open(link.slice(link.indexOf('#')));
    assert.deepEqual(await both(), [true, true]);
    assert.deepEqual([await step(), await run(() => rebond.engine.x.step_now(1))], [20, 20]);
    // To the other solver and back.
    const radio = (value) => run((value) => document.querySelector(`[name="solver"][value="${value}"]`).click(), value);
    const solver = () => run(() => rebond.engine.status(0).solver);
    const first = await solver();
    await radio(first === 'handout' ? 'event-driven' : 'handout');
    await settle();
    assert.deepEqual(await both(), [false, false]);
    assert.notEqual(await solver(), first);
    await page.keyboard.press('z');
    await settle();
    assert.deepEqual([await solver(), ...await both()], [first, true, true]);
  },

  async 'what is written or comes later is not lost without a word'() {
    await open('#scene=first-scene');
    await run(() => { document.getElementById('editor').value += '# mine'; });
    await choose('masses');
    assert.match(await toast(), /put aside/);
    assert.doesNotMatch(await value('editor'), /# mine/);
    await page.keyboard.press('z');
    await settle();
    assert.match(await value('editor'), /# mine$/);
    // The text runs with the same clicks, and one undo returns.
    for (const at of [10, 20, 30]) { await seek(at); await click(3 + at / 10, 2); }
    const before = await lines();
    await press('run-text');
    assert.equal(await lines(), before);
    assert.match(await run(() => rebond.engine.scene(0)), /# mine$/);
    assert.equal(await run(() => !dispatchEvent(new Event('beforeunload', { cancelable: true }))), true, 'the text is in no file');
    await page.keyboard.press('z');
    await settle();
    assert.doesNotMatch(await run(() => rebond.engine.scene(0)), /# mine/);
    assert.equal(await lines(), before);
    await seek(15);
    await click(12, 2);
    assert.equal(await toast(), '2 later events are removed; Z returns them');
    await page.keyboard.press('z');
    await settle();
    assert.equal(await lines(), before);
    // A file of which nothing is accepted changes nothing, not even the recording that is shown.
    await openFile(join(repository, 'recordings/click-session.mcap'));
    await wait(() => rebond.state.film?.verdict);
    writeFileSync(join(folder, 'bad.jsonl'), 'nonsense\n');
    await openFile(join(folder, 'bad.jsonl'));
    await wait(() => !document.getElementById('toast').hidden);
    assert.match(await toast(), /line 1/);
    assert.equal(await run(() => rebond.state.film?.name), 'click-session.mcap');
  },

  async 'two fingers make no box'() {
    await open();
    await run(() => {
      const canvas = document.getElementById('canvas-0');
      canvas.setPointerCapture = () => {};
      const finger = (type, pointerId, clientX) => canvas.dispatchEvent(new PointerEvent(type, { pointerType: 'touch', isPrimary: pointerId === 1, pointerId, clientX, clientY: 300, bubbles: true }));
      finger('pointerdown', 1, 300);
      finger('pointermove', 1, 320);
      finger('pointerdown', 2, 500);
      for (const x of [330, 360, 400]) finger('pointermove', 1, x);
      finger('pointerup', 2, 500);
      finger('pointerup', 1, 400);
    });
    await settle();
    assert.deepEqual([await lines(), await run(() => rebond.view.marks.length)], ['', 0]);
  },

  async 'offers of the panels follow the scene'() {
    await open('#scene=masses');
    const materials = () => run(() => [...document.getElementById('materials').options].map((option) => option.value));
    assert.deepEqual(await materials(), []);
    await choose('');
    assert.deepEqual(await materials(), ['steel', 'wood']);
    await setWorld('set-g', '25');
    assert.equal(await run(() => location.hash), '');
    await choose('pile');
    assert.equal(await run(() => location.hash), '#scene=pile');
    writeFileSync(join(folder, 'heavy.toml'), 'title = "Empty room"\n[run]\nsteps = 60\n[world]\ngravity = [0.0, 2000000.0]\n');
    await openFile(join(folder, 'heavy.toml'));
    await wait(() => rebond.state.status[0].name === 'heavy.toml');
    assert.deepEqual(await run(() => ['value', 'max'].map((key) => Number(document.getElementById('set-g')[key]))), [2e6, 2e6]);
    assert.deepEqual(await run(() => [document.getElementById('set-g').nextElementSibling.value, location.hash]), ['2·10⁶', '']);
    assert.equal(await run(() => document.getElementById('scenes').selectedOptions[0].text), 'Your scene');
    await run(() => { const input = document.getElementById('box-m'); input.value = 'x'; input.dispatchEvent(new Event('input')); document.getElementById('box-fixed').click(); });
    assert.equal(await run(() => document.getElementById('box-m').getAttribute('aria-invalid')), 'false');
  },

  async 'the page is printed without its controls, and names that are pressed are marked in forced colours'() {
    if (!isChromium) return;
    await open('#scene=masses');
    await openPanel('data');
    await page.emulateMediaType('print');
    assert.deepEqual(await run(() => ['header', '#transport', '#panel-close'].map((selector) => getComputedStyle(document.querySelector(selector)).display)), Array(3).fill('none'));
    assert.deepEqual(await run(() => [getComputedStyle(document.getElementById('canvas-0')).objectFit, getComputedStyle(document.querySelector('.scroll')).overflow]), ['contain', 'visible']);
    await page.emulateMediaType();
    const session = await page.createCDPSession();
    await session.send('Emulation.setEmulatedMedia', { features: [{ name: 'forced-colors', value: 'active' }] });
    assert.equal(await run(() => getComputedStyle(document.querySelector('[data-panel="data"]')).outlineStyle), 'solid');
    assert.equal(await run(() => getComputedStyle(document.querySelector('#legend span'), '::before').forcedColorAdjust), 'none');
  },

  async 'what has the focus is above the controls of a phone'() {
    await open('', { width: 360, height: 640 });
    await openPanel('box');
    await run(() => document.getElementById('panel-close').focus());
    for (let i = 0; i < 8; i += 1) {
      await page.keyboard.press('Tab');
      const [id, bottom, top] = await run(() => [document.activeElement.id, document.activeElement.getBoundingClientRect().bottom, document.getElementById('transport').getBoundingClientRect().top]);
      assert.ok(bottom <= top + 1, `${id} ends at ${bottom}, the controls begin at ${top}`);
    }
    // Values stand beside their sliders in a narrow panel, too.
    for (const width of [360, 800]) {
      await page.setViewport({ width, height: 600 });
      await openPanel('world');
      const [slider, output] = await run(() => [document.getElementById('set-g'), document.getElementById('set-g').nextElementSibling].map((element) => element.getBoundingClientRect()).map(({ top, bottom }) => (top + bottom) / 2));
      assert.ok(Math.abs(slider - output) < 10, `${slider} ${output} px`);
    }
  },

  async 'verdicts and collisions are said to screen readers, and systems are asked for dark and for less motion'() {
    await open('#scene=figure-1');
    await press('next');
    await settle();
    assert.match(await run(() => document.getElementById('said').textContent), /collide at/);
    await openFile(join(repository, 'recordings/figure-1.mcap'));
    await wait(() => rebond.state.film?.verdict);
    assert.equal(await run(() => document.getElementById('said').textContent), await run(() => document.getElementById('verdict').textContent));
    assert.equal(await run(() => document.getElementById('said').getAttribute('aria-live')), 'polite');
    // Firefox cannot be asked by its driver.
    if (!isChromium) return;
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }, { name: 'prefers-reduced-motion', value: 'reduce' }]);
    await page.reload();
    await wait(() => document.documentElement.dataset.ready === 'yes');
    assert.equal(await run(() => rebond.view.theme), 'dark');
    assert.equal(await run(() => getComputedStyle(document.getElementById('play')).transitionDuration), '0s');
    await run(() => { rebond.view.show.add('normal'); });
    await press('next');
    await settle();
    assert.deepEqual(await run(() => rebond.stages[0].flashes.map(({ frames }) => frames)), [12], 'a collision is visible');
  },

  async 'the policy allows the script by its hash, WebAssembly, and nothing else'() {
    await open();
    const policy = await run(() => document.querySelector('meta[http-equiv="Content-Security-Policy"]').content);
    assert.match(policy, /^default-src 'none';/);
    assert.match(policy, /script-src 'sha256-[A-Za-z0-9+/]{43}=' (blob: )?'wasm-unsafe-eval'/);
    assert.doesNotMatch(policy, /unsafe-inline'|'unsafe-eval'|https?:|\*/);
    // What the policy forbids does not run.
    assert.equal(await run(async () => {
      const script = document.createElement('script');
      script.textContent = 'window.injected = true';
      document.head.append(script);
      await new Promise((resolve) => { setTimeout(resolve, 100); });
      const isRefused = window.violations.some((violation) => violation.startsWith('script-src'));
      window.violations = [];
      return isRefused && window.injected === undefined;
    }), true);
  },

  async 'an enlargement to 200 % is enough'() {
    await open('#scene=first-scene', { width: 640, height: 400, deviceScaleFactor: 2 });
    for (const panel of ['box', 'world', 'view', 'data', 'files', 'help']) {
      await run((panel) => document.querySelector(`[data-panel="${panel}"]`).click(), panel);
      const [width, canvas] = await run(() => [document.documentElement.scrollWidth, document.getElementById('canvas-0').getBoundingClientRect().height]);
      assert.ok(width <= 640 && canvas >= 200, `${panel}: ${width} px, the world ${canvas} px high`);
    }
  },

  async 'an error stops the loop, is shown, and leaves the session'() {
    await open();
    writeFileSync(join(folder, 'crush.toml'), '[run]\nsteps = 300\n[[spawn]]\nname = "left"\nat = [0.0, 0.0]\nsize = [1.0, 1.0]\nmass = inf\nvelocity = [3.0, 0.0]\n[[spawn]]\nname = "right"\nat = [4.0, 0.0]\nsize = [1.0, 1.0]\nmass = inf\n[[spawn]]\nname = "c"\nat = [2.0, 0.0]\nsize = [1.0, 1.0]\nmass = 1.0\n[restitution]\ndefault = 0.0\n');
    await openFile(join(folder, 'crush.toml'));
    await wait(() => rebond.state.status[0].name === 'crush.toml');
    await press('play');
    await wait(() => !rebond.state.playing);
    assert.match(await toast(), /crushed/);
    assert.deepEqual(await finite(), ['c']);
    await press('back');
    await settle();
    assert.ok(await step() > 10);
  },

  async 'after a failure of the module the session goes on'() {
    await open();
    await click(4, 5);
    await run(() => { rebond.engine.x = { ...rebond.engine.x, step() { throw new WebAssembly.RuntimeError('unreachable'); } }; });
    await press('forward');
    await wait(() => !document.getElementById('toast').hidden);
    assert.deepEqual(await finite(), ['box 1']);
    await press('forward');
    assert.equal(await step(), 1);
  },

  async 'a link holds the session'() {
    await open();
    await click(4, 5);
    await seek(12);
    await run(() => document.querySelector('[data-file="link"]').click());
    await wait(() => document.getElementById('link').value !== '');
    const [link, text, shown] = [await run(() => document.getElementById('link').value), await lines(), await bodies()];
    assert.ok(link.length < 8000);
    await open(link.slice(link.indexOf('#')));
    await settle();
    assert.deepEqual([await lines(), await bodies(), await step()], [text, shown, 12]);
  },

  async 'the keyboard is enough'() {
    await open();
    await run(() => document.getElementById('canvas-0').focus());
    for (let i = 0; i < 4; i += 1) await page.keyboard.press('ArrowLeft');
    assert.match(await run(() => document.getElementById('said').textContent), /7, 4.5 m/);
    await page.keyboard.press('Enter');
    await settle();
    const [body] = await bodies();
    assert.deepEqual([body[0], body[1] + 0.5, body[2] + 0.5], ['box 1', 7, 4.5]);
    await page.keyboard.press('.');
    assert.equal(await step(), 1);
    await page.keyboard.press(' ');
    await wait(() => rebond.engine.x.step_now(0) > 3);
    await page.keyboard.press(' ');
    assert.equal(await run(() => rebond.state.playing), false);
    await run(() => document.querySelector('[data-panel="data"]').click());
    await run(() => document.querySelector('#bodies button').focus());
    const [before] = await bodies();
    await page.keyboard.press('ArrowRight');
    await settle();
    const [after] = await bodies();
    assert.ok(Math.abs(after[1] - before[1] - 0.1) < 1e-9, `${before} ${after}`);
    await page.keyboard.press('Delete');
    await settle();
    assert.deepEqual(await finite(), []);
    await page.keyboard.press('z');
    await settle();
    assert.deepEqual(await finite(), ['box 1']);
  },

  async 'a finger is enough'() {
    await open('', { width: 390, height: 844, hasTouch: true, isMobile: isChromium });
    const at = await place(8, 4);
    // Firefox has no touch emulation for drivers: its finger is a pair of pointer events.
    const tap = () => (isChromium ? page.touchscreen.tap(...at) : run((x, y) => {
      const canvas = document.getElementById('canvas-0');
      canvas.setPointerCapture = () => {};
      for (const type of ['pointerdown', 'pointerup']) {
        canvas.dispatchEvent(new PointerEvent(type, { pointerType: 'touch', isPrimary: true, pointerId: 5, clientX: x, clientY: y, bubbles: true }));
      }
    }, ...at));
    await tap();
    await settle();
    assert.deepEqual(await finite(), ['box 1']);
    await tap();
    await settle();
    assert.deepEqual(await finite(), []);
    // A box of a few pixels is met by a finger beside it.
    for (const id of ['box-w', 'box-h']) await run((id) => { document.getElementById(id).value = '0.2'; }, id);
    await tap();
    await settle();
    assert.deepEqual(await finite(), ['box 3']);
    at[0] += 8;
    await tap();
    await settle();
    assert.deepEqual(await finite(), []);
    await open('#scene=first-scene&both', { width: 360, height: 640 });
    const [bottom, top] = await run(() => [document.getElementById('canvas-1').getBoundingClientRect().bottom, document.getElementById('transport').getBoundingClientRect().top]);
    assert.ok(bottom <= top, `the second world ends at ${bottom}, the controls begin at ${top}`);
  },

  async 'axe finds nothing, in both languages and themes, with every panel'() {
    await open('#scene=first-scene');
    await accessible('at first sight');
    for (const panel of ['box', 'world', 'view', 'data', 'files', 'help']) {
      await run((panel) => document.querySelector(`[data-panel="${panel}"]`).click(), panel);
      await accessible(panel);
    }
    await press('theme');
    await press('language');
    assert.equal(await run(() => document.documentElement.lang), 'fr');
    await press('next');
    await settle();
    await accessible('the collision, in French, in the other theme');
    await run(() => localStorage.clear());
  },

  async 'a width of 320 px is enough, and targets are 44 px'() {
    await open('#scene=first-scene', { width: 320, height: 640 });
    for (const panel of ['box', 'world', 'view', 'data', 'files', 'help']) {
      await run((panel) => document.querySelector(`[data-panel="${panel}"]`).click(), panel);
      const [width, small] = await run(() => [document.documentElement.scrollWidth, [...document.querySelectorAll('button, select, .button, label.check, input[type="number"], textarea')]
        .filter((element) => element.offsetParent && element.getBoundingClientRect().height < 43.9).map((element) => element.id || element.textContent)]);
      assert.ok(width <= 320, `${panel}: ${width} px`);
      assert.deepEqual(small, [], panel);
    }
  },

  async 'every text is in English and in French'() {
    const incomplete = await run(() => Object.entries(PAIRS).filter(([, pair]) => {
      const [en, fr] = pair.map((text) => (typeof text === 'object' ? Object.keys(text).join() : typeof text));
      return pair.length !== 2 || en !== fr;
    }).map(([key]) => key));
    assert.deepEqual(incomplete, []);
    // What the page asks for is there.
    const missing = await run(() => [...document.querySelectorAll('[data-t], [data-l]')].map(({ dataset }) => dataset.t ?? dataset.l).filter((key) => !PAIRS[key]));
    assert.deepEqual(missing, []);
  },

  async 'a click before the engine is there makes its box as soon as it is'() {
    await page?.close();
    page = await browser.newPage();
    await page.setViewport({ width: 1280, height: 800 });
    await page.evaluateOnNewDocument(() => {
      window.violations = [];
      const watch = new MutationObserver(() => {
        if (document.documentElement?.dataset.ready !== 'clicks') return;
        watch.disconnect();
        window.early = typeof rebond;
        const canvas = document.getElementById('canvas-0');
        canvas.setPointerCapture = () => {};
        const box = canvas.getBoundingClientRect();
        for (const type of ['pointerdown', 'pointerup']) {
          canvas.dispatchEvent(new PointerEvent(type, { pointerId: 5, clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true }));
        }
      });
      watch.observe(document, { attributes: true, childList: true, subtree: true });
    });
    await page.goto(url);
    await wait(() => document.documentElement.dataset.ready === 'yes' && rebond.engine.lines(0) !== '');
    assert.equal(await run(() => window.early), 'undefined', 'the engine was not there');
    assert.deepEqual((await bodies()).map(([name, x, y]) => [name, x.toFixed(1), y.toFixed(1)]), [['box 1', '7.5', '4.0']]);
    assert.ok(await run(() => rebond.engine.whole === null || rebond.engine.whole > rebond.times.engine), 'the first part of the module is enough');
  },

  async 'the page makes no request and violates no policy'() {
    assert.deepEqual([...new Set(requests.map((request) => request.split(/[#:]/)[0]))].filter((scheme) => !['file', 'blob', 'data', 'about'].includes(scheme)), []);
    const files = new Set(requests.filter((request) => request.startsWith('file:')).map((request) => request.split('#')[0]));
    // Firefox does not report the page itself.
    assert.deepEqual([...files], isChromium ? [url] : []);
  },
};

/** The number of openings whose times are measured; odd, so that the median is one of them. */
const OPENINGS = 11;

/** Times that are reported and not asserted: they depend on the machine. */
async function measure() {
  const empty = join(folder, 'empty.html');
  writeFileSync(empty, '<!doctype html><script>document.documentElement.dataset.ready = performance.now()</script>');
  // Firefox has a process for files, which this tab keeps.
  const kept = await browser.newPage();
  const [opened, least] = [[], []];
  for (let i = 0; i < OPENINGS; i += 1) {
    await kept.goto(pathToFileURL(empty).href);
    const tab = await browser.newPage();
    await tab.goto(pathToFileURL(empty).href);
    least.push(await tab.evaluate(() => Number(document.documentElement.dataset.ready)));
    await tab.close();
    await open();
    opened.push(await run(() => rebond.times.engine));
  }
  await kept.close();
  const median = (times) => `${times.sort((a, b) => a - b)[(OPENINGS - 1) / 2].toFixed(0)} ms (${times[0].toFixed(0)} at least)`;
  const gas = (count, side) => `[world]\nsize = [${side * 1.6}, ${side}]\nwalls = true\n[run]\nsteps = 600\n[[scatter]]\ncount = ${count}\nseed = 7\nregion = [0, 0, ${side * 1.6}, ${side}]\nsize = [[0.1, 0.1], [0.3, 0.3]]\nmass = [1, 2]\nvelocity = [[-2, -2], [2, 2]]\n`;
  const frames = (count, side, overlays) => run(async (text, overlays) => {
    const { engine, stages, view } = rebond;
    engine.load(0, 'gas.toml', text);
    const stage = stages[0];
    stage.size = engine.status(0).size;
    stage.names = engine.names(0);
    const shown = new Set(overlays ? ['velocity', 'momentum', 'trail', 'name', 'grid', 'normal', 'penetration', 'impulse', 'centre'] : ['velocity']);
    const [step, paint] = [[], []];
    for (let i = 0; i < 60; i += 1) {
      const began = performance.now();
      engine.x.step(0, 1);
      if (overlays) stage.flash(engine.collisions(0), 12);
      const stepped = performance.now();
      stage.bodies = engine.bodies(0, 0, 0).slice();
      if (overlays) stage.extendTrails(60);
      stage.fit();
      stage.draw({ ...view, show: shown, walls: true, marks: [] });
      paint.push(performance.now() - stepped);
      step.push(stepped - began);
      if (i % 10 === 0) await new Promise((resolve) => { setTimeout(resolve); });
    }
    // The least and the median: other programs of the machine only add to a time.
    return [step, paint].map((times) => times.sort((a, b) => a - b)).map((times) => `${times[0].toFixed(1)} to ${times[30].toFixed(1)} ms`);
  }, gas(count, side), overlays);
  const result = { 'an empty page runs its script after': median(least), 'a click makes a box after': median(opened) };
  for (const [count, side, overlays] of [[300, 12, true], [1000, 22, false], [10_000, 70, false]]) {
    const [step, paint] = await frames(count, side, overlays);
    result[`${count} boxes${overlays ? ', all overlays' : ''}`] = `step ${step}, canvas ${paint}`;
  }
  result['recording of a minute of 100 boxes'] = await run(async (text) => {
    const { engine, recording } = rebond;
    engine.load(0, 'gas.toml', text);
    // While it is made, the page answers: the longest time between two tasks.
    let [longest, last, isDone] = [0, performance.now(), false];
    const watch = () => {
      const now = performance.now();
      longest = Math.max(longest, now - last);
      last = now;
      if (!isDone) setTimeout(watch);
    };
    const began = performance.now();
    watch();
    const bytes = await recording(0);
    isDone = true;
    return `${(performance.now() - began).toFixed(0)} ms, ${bytes.length} bytes, nothing waits longer than ${longest.toFixed(0)} ms`;
  }, gas(100, 8).replace('steps = 600', 'steps = 3600'));
  result['an hour of 30 boxes'] = await run(async (text) => {
    const { engine, seek } = rebond;
    const megabytes = () => [engine.x.memory.buffer.byteLength, performance.memory?.usedJSHeapSize].filter(Boolean).map((bytes) => (bytes / 1e6).toFixed(0)).join(' + ');
    engine.load(0, 'gas.toml', text);
    const [before, began] = [megabytes(), performance.now()];
    for (let step = 0; step < 216_000; step += 400) {
      engine.x.step(0, 400);
      await new Promise((resolve) => { setTimeout(resolve); });
    }
    const [after, stepped] = [megabytes(), performance.now()];
    const { step, history, failure } = engine.status(0);
    await seek(108_000);
    return `${step} steps in ${((stepped - began) / 1000).toFixed(0)} s${failure ?? ''}, memory ${before} to ${after} MB, snapshots ${(history / 1e6).toFixed(0)} MB, to its middle ${(performance.now() - stepped).toFixed(0)} ms`;
  }, gas(30, 8));
  return result;
}

let failures = 0;
for (const [title, test] of Object.entries(tests)) {
  if (process.env.ONLY && !title.includes(process.env.ONLY)) continue;
  const began = Date.now();
  try {
    await test();
    assert.deepEqual(await run(() => window.violations), [], 'violations of the policy and errors');
    console.log(`${name}: ok   ${title} (${Date.now() - began} ms)`);
  } catch (error) {
    failures += 1;
    console.log(`${name}: FAIL ${title}\n${error.stack}`);
    const shown = await page?.evaluate(() => document.getElementById('toast-text').textContent).catch(() => '');
    if (shown) console.log(`  the page says: ${shown}`);
  }
}
if (!process.env.ONLY) {
  console.log(`${name} ${await browser.version()}, ${(readFileSync(file).length / 1e6).toFixed(2)} MB`);
  for (const [what, time] of Object.entries(await measure())) console.log(`  ${what}: ${time}`);
}
assert.ok(readFileSync(file).length <= 1.5e6, 'the page has at most 1.5 MB');
await browser.close();
rmSync(folder, { recursive: true });
process.exit(failures ? 1 : 0);
