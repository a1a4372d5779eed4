// A viewer: walkers, how they are shown, and the time that passes for them. What is on the page for it is in controls.js.
import { Walker, WalkerSpace } from "./walker.js";
import { Stage } from "./stage.js";
import { Controls } from "./controls.js";

const MOST_WALKERS = 12;
const SLOWEST = 0.1; // strides a second; at zero there is no walk any more
const TICKS = 6; // frames from one number to the next: nobody reads faster
const LONGEST_FRAME = 0.05; // seconds: a page that was hidden goes on where it was, it does not jump ahead

// prettier-ignore
const SCENE = {
  azimuth: 30, elevation: 0, zoom: 1, perspective: true, speed: 1, // degrees, and times as fast as it is
  sticks: true, dots: true, dotSize: 1, ground: true, sides: true, shading: true, labels: true, black: false,
  invert: false, scramblePlaces: false, scramblePhases: false, mask: 0, seed: 1,
};
const LIMITS = { elevation: [-20, 90], zoom: [0.4, 3], speed: [0.1, 2], dotSize: [0.4, 2.5], mask: [0, 200] };

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** Put a viewer into an element that holds the markup of viewer.html. */
export function openViewer(root, contents, options) {
  return new Viewer(root, contents, options);
}

class Viewer {
  constructor(root, contents, { link = false } = {}) {
    Object.assign(this, { root, contents, selected: 0, ticks: 0, onAlphas: () => {} });
    root.viewer = this;
    this.canvas = root.querySelector("canvas");
    this.space = new WalkerSpace(contents);
    this.stage = new Stage(this.canvas, this.space);
    this.scene = { ...SCENE, harmonics: Array(contents.n_harmonics).fill(true) };
    this.walkers = [new Walker(this.space)];
    this.ends = new AbortController(); // of all that is begun on things outside of the element
    this.tick = this.tick.bind(this);
    this.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.followScreen();
    this.controls = new Controls(this, link);
    this.restore(contents.state);
  }

  get walker() {
    return this.walkers[this.selected];
  }

  get canAdd() {
    return this.walkers.length < MOST_WALKERS;
  }

  /** Stop everything, when a notebook takes the viewer away. */
  close() {
    this.ends.abort();
    cancelAnimationFrame(this.frame);
  }

  // Walkers.

  /** Change the selected walker, and say so if its traits cannot be set like that. */
  change(changes) {
    const done = this.walker.place(changes);
    this.say(done ? "" : "These traits cannot be set independently of each other: release one of them.");
    this.refresh();
    this.onAlphas(this.alphas);
  }

  /** Move a trait and hold it there; short of where the frequency would be zero. */
  setAlpha(trait, alpha) {
    const { walker } = this;
    const [from, frequency, held] = [walker.alphas[trait], walker.frequency, walker.held];
    this.change({ held: new Map(held).set(trait, alpha) });
    if (walker.frequency >= SLOWEST || walker.frequency >= frequency) return;
    const share = clamp((frequency - SLOWEST) / (frequency - walker.frequency), 0, 1); // it is linear in alpha
    this.change({ held: new Map(held).set(trait, from + share * (alpha - from)) });
    this.say("No walk lies further out: its frequency would come to zero.");
  }

  /** Hold a trait where it is, or let it go along with the others. */
  setHold(trait, on) {
    const held = new Map(this.walker.held);
    if (on) held.set(trait, this.walker.alphas[trait]);
    else held.delete(trait);
    this.change({ held });
  }

  addWalker() {
    if (!this.canAdd) return;
    const { walker, held, part, phase } = this.walker;
    this.walkers.push(new Walker(this.space, { walker, held: new Map(held), part, phase }));
    this.select(this.walkers.length - 1);
  }

  removeWalker() {
    if (this.walkers.length === 1) return;
    this.walkers.splice(this.selected, 1);
    this.select(Math.min(this.selected, this.walkers.length - 1));
  }

  select(number) {
    this.selected = number;
    this.say("");
    this.refresh();
    this.onAlphas(this.alphas);
  }

  selectAt(x, y) {
    const isIn = ({ left, top, width, height }) => x >= left && x < left + width && y >= top && y < top + height;
    const number = this.stage.cells.findIndex(isIn);
    if (number >= 0 && number !== this.selected) this.select(number);
  }

  isOutside({ distance }) {
    return this.contents.distance_limit !== null && distance > this.contents.distance_limit;
  }

  // How they are shown.

  setScene(changes) {
    Object.assign(this.scene, changes);
    for (const [name, [low, high]] of Object.entries(LIMITS)) this.scene[name] = clamp(this.scene[name], low, high);
    this.refresh();
  }

  setHarmonic(k, on) {
    this.scene.harmonics[k] = on;
    for (const walker of this.walkers) walker.belt = undefined;
    this.refresh();
  }

  turn(azimuth, elevation) {
    this.setScene({ azimuth: ((((azimuth + 180) % 360) + 360) % 360) - 180, elevation });
  }

  say(text) {
    this.controls.say(text);
  }

  refresh() {
    this.root.classList.toggle("black", this.scene.black);
    this.stage.takeColors();
    this.controls.show();
    this.wake();
  }

  // Time.

  play(on) {
    this.playing = on;
    this.refresh();
  }

  /** Stop, and go on or back by seconds of a walk at its own speed. */
  step(seconds) {
    this.playing = false;
    this.advance(seconds);
    this.refresh();
  }

  /** Stop all walkers at a phase, in degrees. */
  setPhase(degrees) {
    this.playing = false;
    for (const walker of this.walkers) walker.phase = (Math.PI * degrees) / 180;
    this.refresh();
  }

  /** Let time pass for all walkers. */
  advance(seconds) {
    for (const walker of this.walkers) walker.advance(seconds, this.scene.harmonics);
  }

  draw() {
    this.stage.draw(this.walkers, this.scene, this.selected);
  }

  /** Draw with the next frame. */
  wake() {
    if (!this.frame && !this.ends.signal.aborted) this.frame = requestAnimationFrame(this.tick);
  }

  tick(now) {
    this.frame = null;
    const passed = this.last === undefined ? 0 : clamp((now - this.last) / 1000, 0, LONGEST_FRAME);
    if (this.playing) this.advance(passed * this.scene.speed);
    this.last = this.playing ? now : undefined;
    this.draw();
    this.ticks = (this.ticks + 1) % TICKS;
    if (this.playing && this.ticks === 0) this.controls.showPhase();
    if (this.playing && this.visible) this.wake();
  }

  /** Follow what the screen does: its theme, its size, and whether it shows the stage. */
  followScreen() {
    const { signal } = this.ends;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.refresh(), { signal });
    this.visible = true;
    const sizes = new ResizeObserver(() => {
      this.stage.resize(); // which leaves it empty
      this.draw();
    });
    const sights = new IntersectionObserver((entries) => {
      this.visible = entries.at(-1).isIntersecting;
      this.wake();
    });
    for (const observer of [sizes, sights]) {
      observer.observe(this.canvas);
      signal.addEventListener("abort", () => observer.disconnect());
    }
  }

  // Alphas and states, for and from outside.

  /** The held alphas of the selected walker, by the names of the traits. */
  get alphas() {
    return this.namesOf(this.walker.held);
  }

  set alphas(alphas) {
    const held = this.takeAlphas(alphas);
    if (JSON.stringify(this.namesOf(held)) === JSON.stringify(this.alphas)) return;
    this.say(this.walker.place({ held }) ? "" : "These traits cannot be set independently of each other.");
    this.refresh();
  }

  namesOf(held) {
    return Object.fromEntries([...held].map(([trait, alpha]) => [this.contents.traits[trait].name, alpha]));
  }

  takeAlphas(alphas) {
    const { traits } = this.contents;
    const held = Object.entries(alphas ?? {}).map(([name, alpha]) => {
      const trait = traits.findIndex((one) => one.name === name);
      if (trait < 0) throw new Error(`there is no trait ${name} here`);
      const { reach } = traits[trait];
      const isWithin = typeof alpha === "number" && Math.abs(alpha) <= reach;
      if (!isWithin) throw new Error(`${name} must be a number from ${-reach} to ${reach}, not ${alpha}`);
      return [trait, alpha];
    });
    return new Map(held);
  }

  /** Everything that can be changed on the page, as plain data. */
  get state() {
    const walkers = this.walkers.map(({ walker, held, part, phase }) => {
      return { walker, alphas: this.namesOf(held), part, phase };
    });
    return { walkers, selected: this.selected, playing: this.playing, scene: this.scene };
  }

  /** Take a state, all of it or, if anything in it does not fit, nothing. */
  restore({ walkers = [], selected = 0, playing = this.playing, scene = {} }) {
    if (!Array.isArray(walkers)) throw new Error(`walkers must be a list, not ${walkers}`);
    const taken = walkers.slice(0, MOST_WALKERS).map((walker) => this.takeWalker(walker));
    Object.assign(this.scene, this.takeScene(scene));
    if (taken.length) this.walkers = taken;
    this.selected = clamp(Math.trunc(selected) || 0, 0, this.walkers.length - 1);
    this.playing = Boolean(playing);
    this.setScene({});
  }

  takeWalker({ walker = null, alphas, part = null, phase = 0 }) {
    if (walker !== null && !(Number.isInteger(walker) && this.space.scores[walker]))
      throw new Error(`there is no walker ${walker} here`);
    if (![null, "structure", "dynamics"].includes(part)) throw new Error(`there is no part ${part}`);
    const taken = new Walker(this.space, { walker, held: this.takeAlphas(alphas), part, phase: Number(phase) || 0 });
    if (!taken.vector) throw new Error("its traits cannot be set independently of each other");
    return taken;
  }

  /** What is known of a scene, and of the right kind. */
  takeScene(scene) {
    const isRight = (name) => typeof scene[name] === typeof SCENE[name] && scene[name] - scene[name] === 0;
    const known = Object.fromEntries(
      Object.keys(SCENE).flatMap((name) => (isRight(name) ? [[name, scene[name]]] : [])),
    );
    if ("mask" in known) known.mask = clamp(Math.round(known.mask), ...LIMITS.mask);
    if (scene.harmonics?.length === this.contents.n_harmonics) known.harmonics = [...scene.harmonics].map(Boolean);
    return known;
  }

  get link() {
    return `${location.href.split("#")[0]}#${encodeURIComponent(JSON.stringify(this.state))}`;
  }

  /** Take the state out of the end of a link, if there is one. */
  follow(hash) {
    if (hash.length < 2) return;
    try {
      this.restore(JSON.parse(decodeURIComponent(hash.slice(1))));
    } catch (error) {
      this.say(`The link does not fit this page: ${error.message}.`);
    }
  }
}
