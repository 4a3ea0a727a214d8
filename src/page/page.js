// The page: what is clicked, what is shown. The engine owns all states; here are texts, files and the view.

const LIMITS = { file: 64, link: 8000, fragment: 200_000, scene: 2_000_000, rows: 100 };
const SLICE = 8; // ms of work between two frames
const RATES = [15, 30, 60, 120, 240]; // of the slider, Hz; the rate of the scene is added

function pageMain(source) {
  const $ = (id) => document.getElementById(id);
  const all = (selector) => [...document.querySelectorAll(selector)];
  /** A number with four digits, a true minus and a power of ten. */
  function short(number) {
    if (number === Infinity) return '∞';
    if (!Number.isFinite(number)) return '–';
    const rounded = Number(number.toPrecision(4));
    const [digits, power] = (Math.abs(rounded) < 1e6 ? String(rounded) : rounded.toExponential()).split('e');
    const raised = power?.replace('+', '').replace(/./g, (sign) => (sign === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[sign]));
    return local(`${digits.replace('-', '−')}${raised ? `·10${raised}` : ''}`);
  }
  const couple = (x, y) => `(${short(x)}${state.language === 'fr' ? '\u00a0;' : ','} ${short(y)})`;
  /** The text of a number with the decimal separator of the language. */
  const local = (text) => (state.language === 'fr' ? text.replace('.', ',') : text);
  /** The name of a body as it is shown: walls are named by the engine. */
  const shown = (name) => (state.language === 'fr' && Object.hasOwn(WALLS_FR, name) ? WALLS_FR[name] : name);
  const prefers = (query) => globalThis.matchMedia?.(query).matches ?? false;

  /** What an earlier visit kept; some browsers have no storage for files. */
  function kept(key) { try { return localStorage.getItem(key); } catch { return null; } }
  function keep(key, value) { try { localStorage.setItem(key, value); } catch { /* not kept */ } }

  const view = {
    theme: prefers('(prefers-color-scheme: dark)') ? 'dark' : 'light',
    show: new Set(['velocity', 'name', 'clock']), color: 0, marks: [], paused: true, walls: true, reach: {},
  };
  const state = {
    language: (kept('language') ?? navigator.language ?? '').startsWith('fr') ? 'fr' : 'en',
    playing: false, resume: false, held: false, both: false, behind: 0, last: 0, rate: 60, rates: RATES, status: [null, null], journal: [null, null],
    acts: [], film: null, grip: null, saved: new Set(['']), panel: null, turn: 0, seeking: false, busy: 0, scene: '', bundled: [], cursor: null, selected: null, hinted: false,
  };
  const T = () => TEXTS[state.language];
  const stages = [new Stage($('canvas-0')), new Stage($('canvas-1'))];
  let engine;
  const started = {};
  started.promise = new Promise((resolve) => { started.resolve = resolve; });

  // Messages

  function say(text) { $('said').textContent = text; }
  function toast(text, kind = 'bad') {
    $('toast-text').textContent = text;
    $('toast').className = kind;
    $('toast').hidden = false;
    say(text);
  }
  function quiet() { $('toast').hidden = true; }

  /**
   * Runs an action, if need be as soon as there is an engine; a message of the engine is shown, and after a failure of
   * the module the session is restored.
   */
  async function attempt(action) {
    try {
      if (!engine) await started.promise;
      return await action();
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) await recover(error);
      else toast(String(error.message ?? error));
      return undefined;
    }
  }

  async function recover(error) {
    stop();
    let message = String(error.message);
    try { message = engine.text() || message; } catch { /* the memory is gone, too */ }
    engine = await Engine.create();
    Object.assign(state, { film: null, acts: [], seeking: false, busy: 0 });
    stages.forEach((stage) => stage.clear());
    $('film').hidden = true;
    for (const which of [0, 1]) {
      const kept = state.journal[which];
      if (!kept) continue;
      engine.load(which, kept.name, kept.scene, kept.lines);
    }
    refresh();
    toast(T().restarted + message);
  }

  // Sessions

  const worlds = () => (state.both ? [0, 1] : [0]);
  /** The worlds that are shown. */
  const sides = () => (state.film ? [0] : worlds());
  /** The world of the panels. */
  const side = () => (sides().length > 1 ? Number($('side').value) : 0);

  /** Remembers the session, which was changed. */
  function note(which) {
    $('link-label').hidden = true;
    state.journal[which] = { name: state.status[which].name, scene: engine.scene(which), lines: engine.lines(which) };
  }

  /**
   * Starts a session in the place of the present one, to which undo returns. `bundled` is the name of a scene of the
   * page, null for any other.
   */
  function load(name, text, lines = '', bundled = null) {
    engine.load(0, name, text, lines);
    closeFilm();
    const isPutAside = written() && written() !== text;
    remember();
    state.scene = bundled;
    $('editor').value = '';
    showSession();
    showAddress(bundled ? `#scene=${bundled}` : '');
    if (isPutAside) toast(T().textAside, 'good');
  }

  /** Remembers that the sessions were changed, and what was before that. */
  function remember(which = sides(), both = state.both) {
    state.acts.push({ which, both, scene: state.scene, written: written() });
  }

  /** These texts of the session need not be saved. */
  function saved(texts = [engine.scene(0), engine.lines(0)]) { texts.forEach((text) => state.saved.add(text)); }

  /** The text in the editor that is not yet the scene. */
  function written() {
    const { value, defaultValue } = $('editor');
    return value === defaultValue ? '' : value;
  }

  /** Shows the session that the engine has started. */
  function showSession() {
    stop();
    Object.assign(state, { behind: 0, busy: 0, selected: null, cursor: null });
    view.reach = {};
    if (state.both) splitSolvers();
    stages.forEach((stage) => stage.clear());
    showText();
    $('editor-errors').textContent = '';
    refresh();
    if (state.status[0].images) toast(T().images);
    sides().forEach(note);
  }

  /** Shows the text of the scene, unless another one is being written. */
  function showText() {
    const editor = $('editor');
    const kept = written();
    editor.defaultValue = state.film ? state.film.scene : engine.scene(0);
    editor.value = kept || editor.defaultValue;
  }

  /** Starts the session beside, with the other solver. */
  function splitSolvers() {
    engine.ask(engine.x.beside());
    // It has all that was changed in the first session, which is undone in both.
    regroup([0, 1]);
    state.status[1] = engine.status(1);
  }

  /** What was changed in the first session is undone in these ones. */
  function regroup(which) {
    state.acts = state.acts.filter((acted) => acted.which[0] !== 1).map((acted) => ({ ...acted, which: acted.which.length ? which : [] }));
  }

  function refreshStatus() {
    for (const which of sides()) {
      const status = engine.status(which);
      state.status[which] = status;
      if (status.refused.length) {
        toast(T().refused + status.refused.join('\n'));
        note(which);
      }
      if (status.failure && state.told !== status.failure) {
        state.told = status.failure;
        stop();
        toast(T().stopped + status.failure);
      }
      if (!status.failure && which === 0) state.told = null;
    }
    const [first] = state.status;
    state.rate = first.rate;
    state.continuous = first.solver !== 'handout';
    return first;
  }

  /** Shows the present state everywhere. */
  function refresh() {
    $('canvas-1').parentElement.hidden = sides().length < 2;
    if (!state.film) {
      const status = refreshStatus();
      const title = bundledTitle(state.scene, status.title) || status.name;
      nameScene(title);
      document.title = `${title} – rebond`;
      const [gx, gy] = status.gravity ?? [0, 0];
      Object.assign($('set-g'), { min: Math.min(-10, gy), max: Math.max(30, gy), value: gy });
      $('set-e').value = status.restitution;
      state.rates = [...new Set([...RATES, status.rate])].sort((a, b) => a - b);
      $('set-rate').max = state.rates.length - 1;
      $('set-rate').value = state.rates.indexOf(status.rate);
      const value = state.both ? 'both' : status.solver;
      all('[name="solver"]').forEach((radio) => { radio.checked = radio.value === value; });
      $('materials').replaceChildren(...status.materials.map((name) => new Option(name)));
      all('output').forEach(showOutput);
      // The sliders have fewer values than the world.
      setOutput($('set-g'), gx ? couple(gx, gy) : short(gy));
      setOutput($('set-e'), short(status.restitution));
    }
    all('#panel-world input, #clear, #next, #undo').forEach((control) => { control.disabled = state.film !== null; });
    $('world-help').textContent = state.film ? T().fixedFilm : T().worldHelp;
    paint();
    showTime();
    showPanel();
  }

  function showOutput(output) {
    const input = output.previousElementSibling;
    if (!input || output.id === 'clock') return;
    setOutput(input, short(input.id === 'set-rate' ? state.rates[input.value] : Number(input.value)));
  }

  function setOutput(input, text) {
    input.nextElementSibling.value = text;
    input.setAttribute('aria-valuetext', text);
  }

  function paint(offset = 0) {
    view.paused = !state.playing;
    if (!engine) {
      stages[0].fit();
      stages[0].draw(view);
      return;
    }
    for (const which of sides()) {
      const stage = stages[which];
      stage.size = state.film ? state.film.size : state.status[which].size;
      if (state.film) {
        stage.bodies = engine.numbers(engine.x.film_bodies(view.color), Engine.BODY).slice();
      } else {
        stage.bodies = engine.bodies(which, offset, view.color).slice();
      }
      let key = stage.bodies.length;
      for (let i = 0; i < stage.bodies.length; i += Engine.BODY) key = (key * 31 + stage.bodies[i] + 1) % 1e9;
      if (key !== stage.key || stage.film !== state.film) {
        stage.key = key;
        stage.film = state.film;
        stage.names = state.film ? JSON.parse(engine.ask(engine.x.film_names())) : engine.names(which);
      }
      stage.fit();
      view.walls = stage.names.some(([name]) => name === 'wall-top') || stage.names.some(([name]) => name.startsWith('wall-'));
      stage.draw({ ...view, marks: marks(stage) });
    }
    if (state.panel === 'view') showScales();
  }

  /** States at the names of overlays what their lengths mean. */
  function showScales() {
    const { velocity, momentum } = view.reach;
    const metre = (scale, unit) => (scale ? ` (1 m = ${short(1 / scale)} ${unit})` : '');
    const scales = { velocity: metre(velocity, 'm/s'), momentum: metre(momentum, 'kg·m/s'), grid: ` (${short(stages[0].grid)} m)` };
    for (const input of all('#overlays input')) {
      const text = T()[input.value] + (view.show.has(input.value) && scales[input.value] || '');
      const span = input.nextElementSibling;
      if (span.textContent !== text) span.textContent = text;
    }
  }

  function marks(stage) {
    const list = view.marks.slice();
    const picked = stage.names.findIndex(([name]) => name === state.selected);
    if (state.selected && picked >= 0) {
      const b = stage.bodies.subarray(picked * Engine.BODY, (picked + 1) * Engine.BODY);
      list.push({ kind: 'selected', x: b[1], y: b[2], w: b[3], h: b[4] });
    }
    if (state.cursor && document.activeElement === stage.canvas) list.push({ kind: 'cursor', x: state.cursor[0], y: state.cursor[1] });
    return list;
  }

  function showTime() {
    const [step, end, rate] = state.film
      ? [state.film.step, state.film.steps, state.film.rate]
      : [engine.x.step_now(0), Math.max(state.status[0].end, state.status[0].steps, engine.x.step_now(0)), state.rate];
    $('scrub').max = end;
    $('scrub').value = step;
    $('clock').value = local(`${(step / rate).toFixed(2)} s`);
    $('scrub').setAttribute('aria-valuetext', `${$('clock').value}, ${T().steps(step)}`);
    const names = { 'event-driven': T().eventDriven.split(/[:：]/)[0].trim(), handout: T().handout.split(/[:：]/)[0].trim() };
    for (const which of [0, 1]) {
      $(`caption-${which}`).textContent = state.both && !state.film && state.status[which] ? names[state.status[which].solver] : '';
    }
  }

  // Time

  function start() {
    if (state.seeking) return;
    state.playing = true;
    state.resume = false;
    state.behind = 0;
    hideHint();
    showPlay();
    say(T().running);
  }

  function stop() {
    if (state.playing) sayTime();
    Object.assign(state, { playing: false, resume: false });
    showPlay();
  }

  function playOrStop() {
    if (state.playing || state.resume) stop();
    else {
      quiet();
      start();
    }
  }

  function sayTime() { say($('scrub').getAttribute('aria-valuetext')); }

  function showPlay() {
    $('play-icon').setAttribute('d', state.playing ? 'M6 4h4v16H6zM14 4h4v16h-4z' : 'M7 4v16l13-8z');
    $('play').setAttribute('aria-label', state.playing ? T().pause : T().play);
    $('play').title = state.playing ? T().pause : T().play;
  }

  /** One step of all sessions. Returns false after a failure. */
  function stepAll() {
    let going = true;
    for (const which of sides()) {
      if (engine.x.step(which, 1) && which === 0) going = false;
      const stage = stages[which];
      if (view.show.has('normal') || view.show.has('penetration') || view.show.has('impulse')) {
        stage.flash(engine.collisions(which), 12);
      }
      if (view.show.has('trail')) {
        stage.bodies = engine.bodies(which, 0, view.color);
        stage.extendTrails(state.rate);
      }
    }
    return going;
  }

  function frame(now) {
    requestAnimationFrame(frame);
    const passed = Math.min(now - state.last, 100) / 1000;
    state.last = now;
    if (!engine || !state.playing || state.held || state.seeking) return;
    attempt(() => {
      const speed = Number($('speed').value);
      if (state.film) {
        state.behind += passed * state.film.rate * speed;
        const steps = Math.floor(state.behind);
        if (!steps) return;
        state.behind -= steps;
        showFilm(Math.min(state.film.step + steps, state.film.steps));
        if (state.film.step >= state.film.steps) stop();
        return;
      }
      state.behind += passed * state.rate * speed;
      const began = performance.now();
      let going = true;
      while (going && state.behind >= 1) {
        state.behind -= 1;
        going = stepAll();
        if (performance.now() - began > 2 * SLICE) state.behind = Math.min(state.behind, 1);
      }
      const stepped = performance.now();
      // Between two steps the exact solver defines states, too.
      const offset = speed < 1 && state.continuous ? state.behind / state.rate : 0;
      paint(offset);
      state.frame = { step: stepped - began, paint: performance.now() - stepped };
      if (!going) { stop(); refresh(); return; }
      tick += 1;
      if (tick % 6 === 0) { showTime(); refreshStatus(); }
      if (tick % 15 === 0) showPanel();
    });
  }
  let tick = 0;

  const idle = () => new Promise((resolve) => { setTimeout(resolve); });

  /** The states of the next slice, if `states` of them took `took` ms: at most twice as many, because clocks are coarse. */
  const nextSlice = (states, took) => Math.max(1, Math.min(2 * states, Math.round((states * SLICE) / Math.max(took, 0.1))));

  /**
   * Repeats `work` until it returns true, in slices between two frames. Returns false if another call has replaced this
   * one.
   */
  async function inSlices(work) {
    const turn = (state.turn += 1);
    state.seeking = true;
    for (;;) {
      const began = performance.now();
      let done = false;
      while (!done && performance.now() - began < SLICE) done = work();
      if (done) break;
      paint();
      showTime();
      await idle();
      if (state.turn !== turn) return false;
    }
    state.seeking = false;
    return true;
  }

  /** Goes to a step in slices; a later call replaces an earlier one. */
  async function seek(step) {
    const to = Math.max(0, Math.round(step));
    stop();
    if (state.film) {
      Object.assign(state, { turn: state.turn + 1, seeking: false });
      showFilm(Math.min(to, state.film.steps));
      return;
    }
    stages.forEach((stage) => { stage.trails.clear(); stage.flashes = []; });
    for (const which of sides()) engine.x.go_to(which, to);
    await advance();
  }

  /** Reaches the steps that the sessions go to. Returns false if another call has replaced this one. */
  async function advance() {
    const isReached = () => worlds().map((which) => engine.x.advance(which, 4)).every((reached) => reached);
    const done = await inSlices(isReached);
    if (done) refresh();
    return done;
  }

  /** Changes the sessions, reaches the present time again, and goes on if the world ran before the first such change. */
  async function again(change) {
    const resume = state.playing || state.resume;
    stop();
    state.resume = resume;
    try {
      change();
    } finally {
      if (await advance()) {
        sides().forEach(note);
        showText();
        if (state.resume) start();
      }
    }
  }

  async function stepForward() {
    if (state.seeking) return;
    stop();
    if (state.film) showFilm(Math.min(state.film.step + 1, state.film.steps));
    else { stepAll(); refresh(); }
    sayTime();
  }

  async function stepBack() {
    await seek((state.film ? state.film.step : engine.x.step_now(0)) - 1);
    sayTime();
  }

  /** A recording cannot be changed: says so and returns true if one is shown. */
  function isFixed() {
    if (state.film) toast(T().fixedFilm, 'good');
    return state.film !== null;
  }

  /** Runs to the next collision in the world of the panels, stops, and shows its figures. */
  async function nextCollision() {
    if (state.seeking || isFixed()) return;
    stop();
    const first = engine.x.step_now(0);
    const last = first + 60 * state.rate;
    const ends = sides().map((which) => engine.status(which).end);
    let found = false;
    const finished = await inSlices(() => {
      if (!stepAll()) return true;
      found = engine.x.collisions(side()) > 0;
      return found || engine.x.step_now(0) >= last;
    });
    if (!finished) return;
    if (!found && !engine.status(0).failure) {
      for (const which of sides()) engine.x.go_back(which, first, ends[which]);
      stages.forEach((stage) => stage.clear());
      await advance();
      toast(T().noCollision, 'good');
      return;
    }
    refresh();
    if (state.status[0].failure) return;
    openPanel('collision');
    say($('collision-text').textContent);
  }

  // Events

  const isNow = () => !state.playing;

  /** Adds an event to all sessions: to the present state while time stands, else to the next one. */
  async function act(apply) {
    if (isFixed()) return;
    const names = () => new Set(stages[0].names.map(([name]) => name));
    const before = names();
    const undone = [];
    let problem = null;
    engine.x.name_boxes(state.language === 'fr' ? 1 : 0);
    for (const which of sides()) {
      try {
        try {
          apply(which, isNow());
        } catch (error) {
          // An event that the order within a step forbids is possible one step later.
          if (!(error instanceof Refusal) || !isNow()) throw error;
          apply(which, false);
          for (const side of sides()) engine.x.step(side, 1);
          if (engine.status(which).refused.length) throw error;
        }
        undone.push(which);
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
        problem ??= error;
      }
    }
    if (undone.length) remember(undone);
    let removed = 0;
    for (const which of sides()) {
      state.status[which] = engine.status(which);
      removed ||= state.status[which].removed;
      note(which);
    }
    hideHint();
    refresh();
    const after = names();
    const said = [...after].filter((name) => !before.has(name)).map(T().made).concat([...before].filter((name) => !after.has(name)).map(T().gone));
    if (said.length) say(said.join(', '));
    if (removed) toast(T().removed(removed), 'good');
    if (problem) toast(T().refused + problem.message);
  }

  const decimal = (number) => { const text = String(Number(number.toPrecision(12))); return /[.e]/.test(text) ? text : `${text}.0`; };
  const pair = ([x, y]) => `[${decimal(x)}, ${decimal(y)}]`;

  /** A number as typed, with a point or a comma. */
  const typed = (text) => Number(text.trim().replace(',', '.') || NaN);

  function blueprint(velocity) {
    const value = (id) => Number($(id).value);
    const kilograms = typed($('box-m').value);
    const isMass = $('box-fixed').checked || (kilograms >= 0.001 && kilograms < Infinity);
    $('box-m').setAttribute('aria-invalid', !isMass);
    const body = { size: [value('box-w'), value('box-h')], v: velocity ?? [value('box-vx'), value('box-vy')] };
    if (!isMass) return body;
    const mass = $('box-fixed').checked ? '"inf"' : decimal(kilograms);
    const material = $('box-material').value.trim();
    body.json = `{"size": ${pair(body.size)}, "mass": ${mass}, "velocity": ${pair(body.v)}${material ? `, "material": ${JSON.stringify(material)}` : ''}}`;
    return body;
  }

  function click(point, velocity) {
    const { json } = blueprint(velocity);
    if (!json) { toast(T().badMass); return undefined; }
    return act((which, now) => engine.event(which, `{"click": {"at": ${pair(point)}, "spawn": ${json}}}`, now));
  }
  const remove = (name) => act((which, now) => engine.event(which, `{"delete": {"name": ${JSON.stringify(name)}}}`, now));
  const move = async (name, at, v) => {
    let renamed = name;
    await act((which, now) => { renamed = engine.throwBody(which, name, at[0], at[1], v[0], v[1], now); });
    return renamed;
  };

  async function undo() {
    if (isFixed()) return;
    const acted = state.acts.pop();
    if (!acted || (acted.which.length && acted.which.map((which) => engine.x.undo(which)).every(Boolean))) { toast(T().nothingToUndo, 'good'); return; }
    quiet();
    if (acted.scene !== state.scene) {
      state.scene = acted.scene;
      $('scenes').value = state.scene ?? 'own';
    }
    stages.forEach((stage) => stage.clear());
    await again(() => { if (acted.both !== state.both) setBoth(acted.both); });
    if (!written()) $('editor').value = acted.written || $('editor').value;
    say(T().undone);
  }

  async function setting(key, value) {
    if (isFixed()) return;
    await again(() => {
      for (const which of sides()) engine.set(which, key, value);
      remember();
    });
  }

  /** Starts the session beside the first one, or ends it. */
  function setBoth(both) {
    state.both = both;
    if (both) splitSolvers();
    else {
      engine.x.unload(1);
      state.journal[1] = null;
      regroup([0]);
    }
  }

  async function setSolver(value) {
    if (isFixed()) return;
    await again(() => {
      const before = state.both;
      if (before !== (value === 'both')) setBoth(!before);
      const isOther = !state.both && engine.status(0).solver !== value;
      if (isOther) engine.set(0, 'run.solver', `"${value}"`);
      if (isOther || before !== state.both) remember(isOther ? [0] : [], before);
    });
  }

  // Pointer

  function pointer(which) {
    const stage = stages[which];
    const { canvas } = stage;
    let grip = null;
    const release = () => { grip = null; state.grip = null; state.held = false; view.marks = []; };
    canvas.addEventListener('pointerdown', (event) => {
      // A second finger lets go what the first one holds.
      if (event.pointerType === 'touch' && !event.isPrimary) { state.grip?.(); return; }
      if (event.button !== 0 || state.seeking || grip || isFixed()) return;
      const at = stage.point(event);
      const index = bodyAt(which, at, event.pointerType === 'touch' ? 12 : 0);
      if (index < 0 && isOutside(at)) return;
      const b = index < 0 ? null : stage.bodies.slice(index, index + Engine.BODY);
      grip = {
        id: event.pointerId, at, place: [event.clientX, event.clientY], moved: false, b,
        name: b && stage.names[index / Engine.BODY][0], path: [[...at, event.timeStamp]],
      };
      state.grip = () => { release(); paint(); };
      canvas.setPointerCapture(event.pointerId);
      state.cursor = null;
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!grip || event.pointerId !== grip.id) return;
      const at = stage.point(event);
      grip.path.push([...at, event.timeStamp]);
      if (grip.path.length > 40) grip.path.shift();
      grip.moved ||= Math.hypot(event.clientX - grip.place[0], event.clientY - grip.place[1]) > 6;
      if (!grip.moved) return;
      state.held = true;
      view.marks = [ghost(at)];
      paint();
    });
    // A drag of a metre is 2 m/s.
    const thrown = (to, from) => [2 * (to[0] - from[0]), 2 * (to[1] - from[1])];
    const ghost = (at) => {
      const { b } = grip;
      if (b) return { kind: 'ghost', x: b[1] + at[0] - grip.at[0], y: b[2] + at[1] - grip.at[1], w: b[3], h: b[4] };
      const { size: [w, h] } = blueprint();
      const v = thrown(at, grip.at);
      // The arrow is the one that the box will have.
      const scale = view.reach.velocity ?? Math.min(...stage.size) / 36;
      return { kind: 'ghost', x: grip.at[0] - w / 2, y: grip.at[1] - h / 2, w, h, v, scale, text: `${short(Math.hypot(...v))} m/s` };
    };
    canvas.addEventListener('pointerup', (event) => {
      if (!grip || event.pointerId !== grip.id) return;
      const at = stage.point(event);
      const { b, name, moved, path, at: from } = grip;
      const spot = moved || !engine ? ghost(at) : null;
      release();
      if (!engine) { view.marks.push(spot); paint(); }
      attempt(() => {
        if (!moved) return tap(from, b, name);
        if (!b) return click(from, thrown(at, from));
        return move(name, [spot.x, spot.y], state.playing ? speed(path, event.timeStamp) : [b[5], b[6]]);
      });
    });
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('focus', () => { if (canvas.matches(':focus-visible')) { state.cursor ??= stage.size.map((length) => length / 2); } paint(); });
    canvas.addEventListener('blur', () => paint());
    canvas.addEventListener('keydown', (event) => canvasKey(event, which));
  }

  /**
   * The place in the columns of the body at a point, or -1: one of finite mass, or one that an event made. On a touch
   * screen small bodies reach `least` pixels from their centres.
   */
  function bodyAt(which, at, least = 0) {
    const stage = stages[which];
    const isMade = (index) => engine.isMadeByEvent(which, stage.names[index / Engine.BODY][0]);
    return stage.bodyAt(at, isMade, least);
  }

  /** Says so and returns true if a point is beyond the walls. */
  function isOutside([x, y]) {
    const [width, height] = stages[0].size;
    const isBeyond = view.walls && !(x >= 0 && x <= width && y >= 0 && y <= height);
    if (isBeyond) toast(T().outside, 'good');
    return isBeyond;
  }

  /** A click at a point, where the columns `b` of a body named `name` may be. */
  function tap(at, b, name) {
    // The engine’s click passes through infinite masses, and meets a small body only on it.
    const isMissed = b && (b[7] === Infinity || Math.abs(at[0] - b[1] - b[3] / 2) > b[3] / 2 || Math.abs(at[1] - b[2] - b[4] / 2) > b[4] / 2);
    return isMissed ? remove(name) : click(at);
  }

  /** The velocity of the pointer over the last 100 ms, m/s, at most 60. */
  function speed(path, now) {
    const recent = path.filter(([, , time]) => now - time < 100);
    if (recent.length < 2) return [0, 0];
    const [[x0, y0, t0], [x1, y1]] = [recent[0], recent.at(-1)];
    const seconds = Math.max(now - t0, 16) / 1000;
    return [x1 - x0, y1 - y0].map((length) => Math.max(-60, Math.min(60, length / seconds)));
  }

  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

  function canvasKey(event, which) {
    if (state.grip) return;
    const stage = stages[which];
    const arrow = ARROWS[event.key];
    state.cursor ??= stage.size.map((length) => length / 2);
    const index = () => bodyAt(which, state.cursor);
    const name = () => (index() < 0 ? '' : stage.names[index() / Engine.BODY][0]);
    if (arrow) {
      const length = event.shiftKey ? 1 : 0.25;
      state.cursor = state.cursor.map((x, axis) => Math.max(0, Math.min(stage.size[axis], x + arrow[axis] * length)));
      say(T().cursor(short(state.cursor[0]), short(state.cursor[1]), name()));
      paint();
    } else if (event.key === 'Enter') {
      attempt(() => tap(state.cursor, index() < 0 ? null : stage.bodies.slice(index(), index() + Engine.BODY), name()));
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      if (index() >= 0) attempt(() => remove(name()));
    } else return;
    event.preventDefault();
  }

  function pageKey(event) {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const isUndo = key === 'z' && (event.ctrlKey || event.metaKey) && !event.shiftKey;
    if (((event.ctrlKey || event.metaKey) && !isUndo) || event.altKey || $('enlarged').open) return;
    if (state.grip) {
      // While a box is held, a key only lets it go.
      if (key === 'Escape') state.grip();
      event.preventDefault();
      return;
    }
    const of = (controls) => event.target.closest(controls);
    if (key !== 'Escape' && of('textarea, input:not([type="range"]):not([type="checkbox"]):not([type="radio"])')) return;
    // A list goes to the entry that begins with a letter.
    if (key.length === 1 && !isUndo && of('select')) return;
    const keys = {
      ' ': of('button, input:not([type="range"])') ? null : playOrStop,
      ',': stepBack, '.': stepForward, n: nextCollision, z: undo,
      Home: of('button, select, input') ? null : () => seek(0),
      b: () => setSolver(state.both ? state.status[0].solver : 'both'), Escape: () => (state.panel ? closePanel() : quiet()),
    };
    const action = keys[key];
    if (!action) return;
    event.preventDefault();
    attempt(action);
  }

  // Panels

  /** Closes the panel; the focus does not stay in it. */
  function closePanel() {
    const opener = document.querySelector(`[data-panel="${state.panel}"]`) ?? $('play');
    const hadFocus = $('panel').contains(document.activeElement);
    openPanel(null);
    if (hadFocus) opener.focus();
  }

  function openPanel(name) {
    const shown = name === state.panel && name !== 'collision' ? null : name;
    state.panel = shown;
    $('panel').hidden = !shown;
    if (shown) hideHint();
    all('#panel > section').forEach((section) => { section.hidden = section.id !== `panel-${shown}`; });
    all('#tabs button').forEach((button) => button.setAttribute('aria-expanded', button.dataset.panel === shown));
    showPanel();
    paint();
    if (shown) { $('panel').scrollTop = 0; $('panel').scrollIntoView({ block: 'nearest' }); }
  }

  function showSide() { $('side-label').hidden = sides().length < 2 || !['data', 'collision', 'files'].includes(state.panel); }

  function showPanel() {
    showSide();
    if (state.panel === 'data') showData();
    if (state.panel === 'collision' && !state.film) showCollision();
    if (state.panel === 'files') showCommand();
  }

  function showData() {
    const stage = stages[side()];
    for (const id of ['strip', 'legend', 'energy', 'bodies-help', 'recent']) $(id).hidden = state.film !== null;
    if (!state.film) {
      drawStrip($('strip'), engine.numbers(engine.x.energy(side()), 5), state.rate, engine.x.step_now(side()), view.theme, (top, momentum, last) => [
        T().peaks(short(top), short(momentum)), `${short(last)} s`,
      ]);
      engine.x.energy_now(side());
      const [k, p, px, py] = engine.numbers(4, 1);
      $('energy').textContent = T().energy(...[k, p, k + p, px, py].map(short));
    }
    const rows = [];
    let hidden = 0;
    stage.names.forEach(([name], index) => {
      const b = stage.bodies.subarray(index * Engine.BODY, (index + 1) * Engine.BODY);
      if (b[9]) return;
      if (rows.length >= LIMITS.rows) { hidden += 1; return; }
      rows.push([name, [b[7], b[1], b[2], b[5], b[6]].map(short)]);
    });
    const table = $('bodies');
    const focused = document.activeElement?.closest?.('#bodies button')?.textContent;
    while (table.rows.length > rows.length) table.deleteRow(-1);
    rows.forEach(([name, numbers], at) => {
      const row = table.rows[at] ?? newRow(table, 5);
      const button = row.cells[0].firstChild;
      if (button.textContent !== name) button.textContent = name;
      button.setAttribute('aria-pressed', name === state.selected);
      numbers.forEach((number, column) => { row.cells[column + 1].textContent = number; });
      if (name === focused && document.activeElement !== button) button.focus();
    });
    if (hidden) { const row = table.insertRow(); row.insertCell().textContent = T().more(hidden); row.cells[0].colSpan = 6; }
    if (state.film) return;
    const recent = JSON.parse(engine.ask(engine.x.recent_collisions(side())));
    const collisions = recent.slice(-LIMITS.rows).reverse().map(([t, c, b, nx, ny, e, before, after, j]) => {
      const row = document.createElement('tr');
      const normal = nx > 0 ? '→' : nx < 0 ? '←' : ny > 0 ? '↓' : '↑';
      for (const text of [short(t), shown(c), shown(b), normal, short(e), short(before), short(after), short(j)]) row.insertCell().textContent = text;
      return row;
    });
    $('collisions').replaceChildren(...collisions);
  }

  function newRow(table, numbers) {
    const row = table.insertRow();
    const button = document.createElement('button');
    button.type = 'button';
    row.insertCell().append(button);
    for (let i = 0; i < numbers; i += 1) row.insertCell();
    return row;
  }

  /** Moves or deletes the body whose name has the focus. */
  function listKey(event) {
    const button = event.target.closest('button');
    if (!button || state.film) return;
    const name = button.textContent;
    const stage = stages[side()];
    const index = stage.names.findIndex(([other]) => other === name);
    if (index < 0) return;
    const b = stage.bodies.slice(index * Engine.BODY, (index + 1) * Engine.BODY);
    const arrow = ARROWS[event.key];
    if (arrow) {
      const length = event.shiftKey ? 1 : 0.1;
      const at = [b[1] + arrow[0] * length, b[2] + arrow[1] * length];
      attempt(async () => {
        const renamed = await move(name, at, [b[5], b[6]]);
        state.selected = renamed;
        say(T().moved(renamed, short(at[0]), short(at[1])));
        showData();
        [...$('bodies').querySelectorAll('button')].find((other) => other.textContent === renamed)?.focus();
      });
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      const at = button.closest('tr').rowIndex - 1;
      attempt(async () => {
        await remove(name);
        const left = $('bodies').querySelectorAll('button');
        (left[Math.min(at, left.length - 1)] ?? $('bodies').closest('.scroll')).focus();
      });
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  function showCollision() {
    const c = engine.collisions(side()).slice();
    const { bodies, names } = stages[side()];
    const name = (id) => shown(names[[...names.keys()].find((n) => bodies[n * Engine.BODY] === id)]?.[0] ?? `#${id}`);
    const indices = [...Array(c.length / Engine.COLLISION).keys()];
    $('pick').hidden = indices.length < 2;
    const step = `${side()}:${engine.x.step_now(side())}`;
    const key = `${step} ${indices} ${view.theme} ${state.language}`;
    if (!indices.length) {
      $('collision-text').textContent = T().noCollision;
      $('collision-numbers').replaceChildren();
      all('[data-figure]').forEach((button) => { button.hidden = true; });
      state.figureKey = null;
      return;
    }
    if (state.figureKey === key) return;
    if (state.figureKey?.split(' ')[0] !== step || $('collision-index').options.length !== indices.length) {
      $('collision-index').replaceChildren(...indices.map((i) => new Option(`${name(c[i * Engine.COLLISION])} – ${name(c[i * Engine.COLLISION + 1])}`, i)));
    }
    state.figureKey = key;
    const index = Number($('collision-index').value);
    const n = c.slice(index * Engine.COLLISION, (index + 1) * Engine.COLLISION);
    const [a, b] = [name(n[0]), name(n[1])];
    $('collision-text').textContent = T().collided(a, b, short(n[8]));
    const rows = { a, b, t: `${short(n[8])} s`, n: couple(n[2], n[3]), e: short(n[4]), before: `${short(n[6])} m/s`, after: `${short(n[7])} m/s`, j: `${short(n[5])} N·s`, p: `${couple(n[9], n[10])} m` };
    const [nc, nb] = n.subarray(19);
    // The event-driven solver displaces no body.
    if (nc || nb) Object.assign(rows, { nc: short(nc), nb: short(nb), dc: `${couple(nc * n[9], nc * n[10])} m`, db: `${couple(-nb * n[9], -nb * n[10])} m` });
    $('collision-numbers').replaceChildren(...Object.entries(rows).flatMap(([key, text]) => {
      const [dt, dd] = [document.createElement('dt'), document.createElement('dd')];
      dt.textContent = T().numbers[key];
      dd.textContent = text;
      return [dt, dd];
    }));
    for (const kind of [0, 1]) {
      const image = $(`figure-${kind + 1}`);
      attempt(() => {
        const svg = engine.file(engine.x.figure(side(), index, kind, view.theme === 'dark' ? 1 : 0, state.language === 'fr' ? 1 : 0));
        if (image.src.startsWith('blob:')) URL.revokeObjectURL(image.src);
        image.src = URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' }));
        image.alt = `${T()[`figure${kind + 1}`]}: ${T().collided(a, b, short(n[8]))}`;
        image.parentElement.hidden = false;
      });
    }
  }

  // Files out

  const base = () => (state.film ? state.film.name : state.status[side()].name).replace(/\.(toml|mcap)$/, '') + (side() ? '-2' : '');

  function download(name, bytes, type = 'application/octet-stream') {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([bytes], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    toast(T().saved(name), 'good');
  }

  /** The recording of the session, made in slices, or the one that is open. */
  async function recording(which) {
    if (state.film) return state.film.bytes;
    engine.ask(engine.x.save_start(which));
    const { busy } = state;
    const last = engine.status(which).recorded_steps;
    const began = performance.now();
    let states = 16;
    for (;;) {
      const sliced = performance.now();
      const code = engine.x.save_advance(states);
      if (code) return engine.file(code === 1 ? 1 : 0);
      states = nextSlice(states, performance.now() - sliced);
      if (sliced - began > 500 && !$('toast').hidden) $('toast-text').textContent = T().progress(local((100 * engine.x.save_step() / last).toFixed(1)));
      await idle();
      if (state.busy !== busy) {
        engine.x.save_stop();
        throw new Refusal(T().notSaved);
      }
    }
  }

  function lookOptions(size) {
    const names = { velocity: 'velocity', momentum: 'momentum', normal: 'normal', impulse: 'impulse', penetration: 'penetration', centre: 'com', trail: 'trail', name: 'name', grid: 'grid', clock: 'clock' };
    const show = Object.keys(names).filter((name) => view.show.has(name)).map((name) => names[name]);
    const color = ['body', 'material', 'speed'][view.color];
    const flags = `--size ${size.join('x')} --theme ${view.theme} --show ${show.join(',') || 'none'} --color-by ${color}${state.language === 'fr' ? ' --language fr' : ''}`;
    return { json: JSON.stringify({ size, theme: view.theme, show, color_by: color, language: state.language }), flags };
  }

  const present = () => (state.film ? state.film.step : engine.x.step_now(side()));

  function showCommand() {
    const { flags } = lookOptions([1280, 720]);
    const quoted = (name) => (/^\w[\w.+-]*$/.test(name) ? name : `'${name.replaceAll("'", "'\\''")}'`);
    $('command').textContent = T().command(`rebond render ${quoted(`${base()}.mcap`)} -o ${quoted(`${base()}.png`)} --at ${present()} ${flags}`);
  }

  /** Does a job in a worker, so that the page stays usable; without workers, here. */
  function workBeside(job) {
    return new Promise((resolve, reject) => {
      let worker;
      const here = () => work(job).then(resolve, reject);
      try {
        const url = URL.createObjectURL(new Blob([source], { type: 'text/javascript' }));
        worker = new Worker(url);
        URL.revokeObjectURL(url);
      } catch { here(); return; }
      worker.onerror = () => { worker.terminate(); here(); };
      worker.onmessage = ({ data }) => {
        worker.terminate();
        if (data.error) reject(new Refusal(data.error));
        else resolve(data.result);
      };
      try { worker.postMessage(job); } catch { worker.terminate(); here(); }
    });
  }

  async function save(kind) {
    const which = side();
    const name = base();
    const step = present();
    if (state.busy) return;
    const busy = (state.busy = performance.now());
    const film = state.film;
    const [scene, lines] = [engine.scene(0), engine.lines(0)];
    stop();
    toast(T().working, 'good');
    try {
      if (kind === 'mcap') download(`${name}.mcap`, await recording(which));
      else if (kind === 'toml') download(`${name}.toml`, film ? film.scene : engine.ask(engine.x.recorded_scene(which)));
      else if (kind === 'clicks') download(`${name}-clicks.toml`, engine.ask(film ? engine.x.film_scene_with_events() : engine.x.scene_with_events(which)));
      else if (kind === 'jsonl') download(`${name}.jsonl`, film ? engine.ask(engine.x.film_lines()) : engine.lines(which));
      else if (kind === 'link') await makeLink(sides().length > 1 ? 0 : which);
      else {
        const file = await recording(which);
        const table = { states: 0, collisions: 1 }[kind];
        const options = lookOptions(kind === 'gif' ? [640, 360] : [1280, 720]).json;
        engine.complete();
        const modules = [Engine.core, Engine.rest];
        const job = { modules, recording: file, format: table === undefined ? kind : 'csv', table, step, options };
        const bytes = await workBeside(job);
        if (state.busy !== busy) throw new Refusal(T().notSaved);
        const type = { png: 'image/png', svg: 'image/svg+xml', gif: 'image/gif' }[kind] ?? 'text/csv';
        download(table === undefined ? `${name}.${kind}` : `${name}-${kind}.csv`, bytes, type);
      }
      // Clicks made meanwhile are in no file.
      if (!film && ['mcap', 'clicks', 'link'].includes(kind)) saved([scene, lines]);
      if (!film && kind === 'toml') saved([scene]);
      if (!film && kind === 'jsonl') saved([lines]);
    } finally {
      if (state.busy === busy) state.busy = 0;
    }
  }

  async function makeLink(which) {
    const session = { n: state.film?.name ?? state.status[which].name, s: state.film?.scene ?? engine.scene(which), l: state.film ? engine.ask(engine.x.film_lines()) : engine.lines(which), t: present() };
    if (sides().length > 1) session.b = 1;
    const packed = toBase64(await compressed(encoder.encode(JSON.stringify(session)), 'deflate-raw'));
    const fragment = `s=${packed.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
    if (fragment.length > LIMITS.link) { toast(T().linkLong(fragment.length)); document.querySelector('[data-file="clicks"]').focus(); return; }
    const link = `${location.href.split('#')[0]}#${fragment}`;
    $('link').value = link;
    $('link-label').hidden = false;
    $('link').select();
    try { await navigator.clipboard.writeText(link); toast(T().linkCopied, 'good'); } catch { quiet(); }
  }

  /** Makes the fragment of the address name the scene that is shown. */
  function showAddress(hash) {
    try { history.replaceState(null, '', location.href.split('#')[0] + hash); } catch { /* a page in a frame may not */ }
  }

  /** Opens what the fragment of the address names: `#s=SESSION`, or `#scene=NAME` with `&both` and `&t=STEP`. */
  async function openFragment() {
    const { hash } = location;
    const fragment = hash.slice(1);
    if (!fragment) return false;
    try {
      if (fragment.length > LIMITS.fragment) throw new Error(`${fragment.length} bytes`);
      if (fragment.startsWith('s=')) {
        const packed = fromBase64(fragment.slice(2).replaceAll('-', '+').replaceAll('_', '/').replace(/[^A-Za-z0-9+/]/g, '?').padEnd(Math.ceil((fragment.length - 2) / 4) * 4, '='));
        const session = JSON.parse(decoder.decode(await decompressed(packed, 'deflate-raw', LIMITS.scene)));
        load(String(session.n || 'scene.toml').replace(/[\r\n/\\]/g, ' ').slice(0, 200), String(session.s), String(session.l ?? ''));
        if (session.b) await setSolver('both');
        saved();
        showAddress(hash);
        await seek(Math.min(Math.max(Number(session.t) || 0, 0), 1e6));
        return true;
      }
      const wanted = new URLSearchParams(fragment);
      const name = wanted.get('scene');
      const found = bundled().find(([other]) => other === name);
      if (!found) throw new Error(name ? `there is no scene ${JSON.stringify(name)}` : 'it names no scene');
      choose(name);
      showAddress(hash);
      if (wanted.has('both')) await setSolver('both');
      if (wanted.has('t')) await seek(Math.min(Number(wanted.get('t')) || 0, 1e6));
      return true;
    } catch (error) {
      toast(T().linkBad + String(error.message ?? error));
      return false;
    }
  }

  // Files in

  async function openFile(file) {
    if (!file) return;
    if (file.size > LIMITS.file * 1e6) { toast(T().tooLarge(LIMITS.file)); return; }
    const bytes = new Uint8Array(await file.arrayBuffer());
    const name = file.name.replace(/[\r\n/\\]/g, ' ');
    const [, ending] = /\.(\w+)$/.exec(name.toLowerCase()) ?? [];
    const text = () => {
      try { return new TextDecoder('utf-8', { fatal: true }).decode(bytes); } catch { throw new Refusal(T().notText(name)); }
    };
    const magic = bytes[0] === 0x89 && decoder.decode(bytes.subarray(1, 5)) === 'MCAP';
    if (magic || ending === 'mcap') await openFilm(name, bytes);
    else if (ending === 'jsonl') {
      const events = text();
      for (const which of worlds()) engine.setLines(which, events);
      closeFilm();
      stop();
      remember();
      refresh();
      sides().forEach(note);
      saved([engine.lines(0)]);
    } else if (ending === 'toml') {
      load(name, text());
      saved();
    } else toast(T().unknownFile);
  }

  async function openFilm(name, bytes) {
    stop();
    const about = engine.film(bytes);
    state.film = { ...about, name, bytes, step: 0, written: state.film ? state.film.written : written() };
    view.reach = {};
    if (state.panel === 'collision') openPanel(null);
    stages[0].trails.clear();
    nameScene(about.title || name);
    document.title = `${about.title || name} – rebond`;
    $('film').hidden = false;
    $('film-title').textContent = name;
    $('film-step').hidden = true;
    $('film-scene').hidden = !about.scene;
    $('editor').value = '';
    showText();
    quiet();
    refresh();
    showFilm(0);
    hideHint();
    await replayFilm(state.film);
  }

  /** Replays the recording in slices, with the verdict so far. */
  async function replayFilm(film) {
    const shown = $('verdict');
    const show = (text, kind) => { shown.textContent = text; shown.className = kind; };
    show('', '');
    $('film-progress').hidden = false;
    $('film-progress').value = 0;
    try {
      engine.ask(engine.x.verdict_start());
      for (let states = 16; ;) {
        const began = performance.now();
        const verdict = JSON.parse(engine.ask(engine.x.verdict_advance(states)));
        if (state.film !== film) return;
        $('film-progress').value = film.steps ? verdict.step / film.steps : 1;
        if (verdict.final) {
          show(verdict.line, verdict.word === 'same' ? '' : 'bad');
          say(verdict.line);
          film.verdict = verdict;
          if (verdict.diverged !== null) {
            $('film-step').hidden = false;
            showDivergence();
          }
          break;
        }
        // Before its end a recording is not yet complete.
        show(verdict.word === 'incomplete' ? T().sameSoFar(verdict.step) : verdict.line, '');
        states = nextSlice(states, performance.now() - began);
        await idle();
        if (state.film !== film) return;
      }
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw error;
      show(String(error.message ?? error), 'bad');
      say(String(error.message ?? error));
    }
    $('film-progress').hidden = true;
  }

  function showDivergence() { $('film-step').textContent = T().divergedAt(state.film.verdict.diverged); }

  function showFilm(step) {
    state.film.step = Number(engine.ask(engine.x.film_show(step)));
    paint();
    if (view.show.has('trail') && state.playing) stages[0].extendTrails(state.film.rate);
    showTime();
    if (!state.playing || (tick += 1) % 15 === 0) showPanel();
  }

  function closeFilm() {
    if (!state.film) return;
    const kept = state.film.written;
    state.film = null;
    engine.x.film_close();
    $('film').hidden = true;
    stop();
    $('scenes').querySelector('[value="own"]')?.remove();
    $('scenes').value = state.scene ?? 'own';
    $('editor').value = '';
    showText();
    $('editor').value = kept || $('editor').value;
    refresh();
  }

  // Language, theme, start

  function translate() {
    document.documentElement.lang = state.language;
    $('language').textContent = state.language === 'fr' ? 'English' : 'Français';
    $('language').lang = state.language === 'fr' ? 'en' : 'fr';
    for (const element of all('[data-t]')) element.textContent = T()[element.dataset.t];
    for (const element of all('[data-l]')) {
      element.setAttribute('aria-label', T()[element.dataset.l]);
      if (element.tagName === 'BUTTON') element.title = T()[element.dataset.l];
    }
    if (state.film?.verdict) showDivergence();
    $('help').replaceChildren(...T().helpLines.map((line) => { const li = document.createElement('li'); li.textContent = line; return li; }));
    for (const [name, text] of state.bundled) $('scenes').querySelector(`[value="${name}"]`).textContent = bundledTitle(name, titleOf(text, name));
    if (!state.hinted) $('hint').textContent = T().hint;
    showPlay();
  }

  function hideHint() { state.hinted = true; $('hint').textContent = ''; }

  function setTheme(theme) {
    view.theme = theme;
    document.documentElement.dataset.theme = theme;
  }

  function choose(name) {
    const text = name ? bundled().find(([other]) => other === name)?.[1] : undefined;
    load(name ? `${name}.toml` : 'room.toml', text ?? EMPTY_ROOM, '', text ? name : '');
    saved();
    $('scenes').value = text ? name : '';
  }

  /** Shows the title of a scene that is not bundled among the scenes. */
  function nameScene(title) {
    $('title').textContent = title;
    if (state.scene !== null && !state.film) return;
    const options = $('scenes').options;
    const own = [...options].find((option) => option.value === 'own') ?? new Option('', 'own');
    const isTaken = [...options].some((option) => option !== own && option.textContent === title);
    own.textContent = isTaken && !state.film ? T().ownScene : title;
    if (!own.parentNode) $('scenes').add(own, 0);
    $('scenes').value = 'own';
  }

  /** The title of a scene of the page in the language of the page, or the given one of another scene. */
  const bundledTitle = (name, title) => (name === '' ? T().emptyRoom : (state.language === 'fr' && TITLES_FR[name]) || title);

  function titleOf(text, name) { return /^title = "((?:[^"\\]|\\.)*)"/m.exec(text)?.[1] ?? name; }

  function wire() {
    const on = (id, event, action) => $(id).addEventListener(event, (ev) => { attempt(() => action(ev)); });
    on('play', 'click', playOrStop);
    on('forward', 'click', stepForward);
    on('back', 'click', stepBack);
    on('restart', 'click', () => seek(0));
    on('next', 'click', nextCollision);
    on('undo', 'click', undo);
    on('scrub', 'input', () => seek(Number($('scrub').value)));
    on('scenes', 'change', () => { quiet(); if ($('scenes').value !== 'own') choose($('scenes').value); });
    on('language', 'click', () => { state.language = state.language === 'fr' ? 'en' : 'fr'; keep('language', state.language); translate(); state.figureKey = null; refresh(); });
    on('theme', 'click', () => { setTheme(view.theme === 'dark' ? 'light' : 'dark'); refresh(); });
    // Closing the message of a file that is being made ends that, too.
    on('toast-close', 'click', () => { quiet(); state.busy = 0; });
    on('panel-close', 'click', closePanel);
    on('side', 'change', showPanel);
    on('clear', 'click', async () => { stop(); for (const which of sides()) engine.setLines(which, ''); remember(); await seek(0); sides().forEach(note); say(T().cleared); });
    on('set-g', 'change', () => setting('world.gravity', pair([state.status[0].gravity?.[0] ?? 0, Number($('set-g').value)])));
    on('set-e', 'change', () => setting('restitution.default', decimal(Number($('set-e').value))));
    on('set-rate', 'change', () => setting('run.rate', decimal(state.rates[$('set-rate').value])));
    on('solvers', 'change', (event) => setSolver(event.target.value));
    on('colour', 'change', () => { view.color = Number($('colour').value); refresh(); });
    on('collision-index', 'change', () => { state.figureKey = `${side()}:${engine.x.step_now(side())} -`; showCollision(); });
    on('open', 'change', async () => { const [file] = $('open').files; await openFile(file); $('open').value = ''; });
    on('run-text', 'click', () => {
      try {
        const lines = state.film ? engine.ask(engine.x.film_lines()) : engine.lines(0);
        load(state.film ? `${base()}.toml` : state.status[0].name, $('editor').value, lines);
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
        $('editor-errors').textContent = error.message;
      }
    });
    all('[data-figure]').forEach((button) => button.addEventListener('click', () => {
      const image = button.firstChild;
      $('enlarged-image').src = image.src;
      $('enlarged-image').alt = image.alt;
      $('enlarged').showModal();
    }));
    on('enlarged-close', 'click', () => $('enlarged').close());
    on('film-close', 'click', closeFilm);
    on('film-scene', 'click', () => { load(`${base()}.toml`, state.film.scene, engine.ask(engine.x.film_lines())); saved(); });
    on('film-step', 'click', () => showFilm(Math.min(state.film.verdict.diverged, state.film.steps)));
    on('box-m', 'input', () => blueprint());
    on('box-fixed', 'change', () => blueprint());
    on('bodies', 'click', (event) => { const button = event.target.closest('button'); if (button) { state.selected = state.selected === button.textContent ? null : button.textContent; refresh(); } });
    $('bodies').addEventListener('keydown', listKey);
    all('[data-panel]').forEach((button) => button.addEventListener('click', ({ detail }) => attempt(() => {
      openPanel(button.dataset.panel);
      // The panel comes before its tab: from the keyboard, the focus goes there.
      if (state.panel && !detail) $('panel').focus();
    })));
    // After a click on a control, or a choice with the pointer, Space and letters act on the world.
    let isPointer = false;
    addEventListener('pointerdown', () => { isPointer = true; }, true);
    addEventListener('keydown', () => { isPointer = false; }, true);
    addEventListener('click', ({ detail, target }) => { if (detail && target.closest?.('header button, #transport button, #film button, #panel-close')) document.activeElement.blur(); });
    all('header select, #transport select').forEach((select) => select.addEventListener('change', () => { if (isPointer) select.blur(); }));
    addEventListener('beforeunload', (event) => { if (engine && ![engine.scene(0), engine.lines(0)].every((text) => state.saved.has(text)) || written()) event.preventDefault(); });
    all('[data-file]').forEach((button) => button.addEventListener('click', () => attempt(() => save(button.dataset.file))));
    all('input[type="range"]').forEach((input) => input.addEventListener('input', () => { const output = input.nextElementSibling; if (output) showOutput(output); }));
    addEventListener('keydown', pageKey);
    addEventListener('resize', () => paint());
    new ResizeObserver(() => paint()).observe($('stages'));
    addEventListener('hashchange', () => attempt(openFragment));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => attempt(() => { setTheme(event.matches ? 'dark' : 'light'); refresh(); }));
    let depth = 0;
    const isFile = (event) => event.dataTransfer?.types?.includes('Files');
    addEventListener('dragenter', (event) => { if (isFile(event)) { depth += 1; $('drop').hidden = false; } });
    addEventListener('dragleave', (event) => { if (isFile(event) && (depth -= 1) <= 0) { depth = 0; $('drop').hidden = true; } });
    addEventListener('dragover', (event) => { if (isFile(event)) event.preventDefault(); });
    addEventListener('drop', (event) => {
      if (!isFile(event)) return;
      event.preventDefault();
      depth = 0;
      $('drop').hidden = true;
      attempt(() => openFile(event.dataTransfer.files[0]));
    });
  }

  function makeOverlays() {
    for (const name of ['velocity', 'momentum', 'trail', 'name', 'grid', 'normal', 'penetration', 'impulse', 'centre', 'clock']) {
      const label = document.createElement('label');
      label.className = 'check';
      const input = Object.assign(document.createElement('input'), { type: 'checkbox', value: name, checked: view.show.has(name) });
      input.addEventListener('change', () => attempt(() => { view.show[input.checked ? 'add' : 'delete'](name); refresh(); }));
      label.append(input, document.createElement('span'));
      $('overlays').append(label);
    }
  }

  /** Takes clicks, which make boxes as soon as there is an engine. The markup has the English texts. */
  function openRoom() {
    setTheme(view.theme);
    if (state.language !== 'en') translate();
    stages[0].fit();
    pointer(0);
    pointer(1);
    wire();
    document.documentElement.dataset.ready = 'clicks';
  }

  /** The bundled scenes, which are in the rest of the module. */
  function bundled() {
    if (!state.bundled.length) {
      engine.x.bundled();
      state.bundled = JSON.parse(engine.text());
      for (const [name, text] of state.bundled) $('scenes').add(new Option(bundledTitle(name, titleOf(text, name)), name));
    }
    return state.bundled;
  }

  async function begin() {
    // Not beside the page: what waits for its turn comes after layout and painting.
    Engine.core = new WebAssembly.Module(inflated());
    engine = await Engine.create();
    view.marks = [];
    showSession();
    saved();
    started.resolve();
    const times = { engine: performance.now() };
    globalThis.rebond = { get engine() { return engine; }, state, view, stages, times, seek, click, openFile, recording };
    requestAnimationFrame(frame);
    // The browser reads and shows the page first.
    if (document.readyState === 'loading') await new Promise((resolve) => { addEventListener('DOMContentLoaded', resolve); });
    await idle();
    makeOverlays();
    translate();
    await openFragment();
    Engine.rest ??= await workBeside({ rest: packedRest() });
    engine.complete();
    bundled();
    document.documentElement.dataset.ready = 'yes';
  }

  openRoom();
  begin().catch((error) => { paint(); $('hint').textContent = String(error.message ?? error); });
}

if (typeof document !== 'undefined') pageMain(document.currentScript.textContent);
