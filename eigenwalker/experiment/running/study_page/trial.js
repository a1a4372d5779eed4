// One trial: walks on a stage, and buttons to answer with.
import { CanvasWalk, Figure } from "./figure.js";
import { FramedMotion, HarmonicMotion } from "./motion.js";
import { MovieWalk } from "./movie.js";
import { timeOf } from "./timing.js";

const SECOND = 1000;
const ORDINALS = { 1: "st", 2: "nd", 3: "rd" };
const SIDES = ["Left walk", "Right walk"];

const rounded = (number) => Math.round(1e6 * number) / 1e6;

/** 1st, 2nd, 3rd, 4th, 11th. */
export function ordinal(number) {
  const isTeen = Math.floor(number / 10) % 10 === 1;
  return `${number}${(!isTeen && ORDINALS[number % 10]) || "th"}`;
}

/** The buttons of a row from left to right: those of ratings are turned round where the row says so. */
export function buttonsOf(task, row) {
  const isTurned = !task.pair && row.left !== "" && row.left === task.buttons.at(-1).text;
  return isTurned ? [...task.buttons].reverse() : task.buttons;
}

/** The names of the walks of a row, from left to right. */
export function namesOf(task, row) {
  if (!task.pair) return [row.stimulus];
  return row.left === row.stimulus ? [row.stimulus, row.reference] : [row.reference, row.stimulus];
}

/** What the words over an attention trial ask for. */
export function attentionWords(buttons, expected) {
  const place = buttons.findIndex(({ answer }) => answer === expected);
  const { text = "" } = buttons[place] ?? {};
  const button = text ? `“${text}”` : `the ${ordinal(place + 1)} button from the left`;
  return `Attention: please choose ${button}`;
}

export class Trial {
  /** `element` holds the markup of a trial and as many buttons as the task has; `screen` says how it is measured. */
  constructor(element, { row, task, contents, space, screen }) {
    Object.assign(this, { element, row, task, contents, space, screen });
    Object.assign(this, { plays: [], running: [], first: null, pressed: null });
    this.ends = new AbortController(); // of everything that moves or listens
    this.buttons = buttonsOf(task, row);
    this.elements = [...element.querySelectorAll(".answer")];
    this.answered = new Promise((resolve, reject) => Object.assign(this, { resolve, reject }));
    this.build();
  }

  find(selector) {
    return this.element.querySelector(selector);
  }

  // What is on the page.

  build() {
    const { row, task, buttons } = this;
    const isAttention = row.part === "attention";
    this.find(".question").textContent = task.question;
    this.find(".note").textContent = isAttention ? attentionWords(buttons, row.expected) : "";
    this.find(".note").classList.toggle("attention", isAttention);
    this.elements.forEach((element, i) => this.label(element, i));
    this.walks = namesOf(task, row).map((name, i) => this.buildWalk(name, i));
    this.lay();
    const watcher = new ResizeObserver(() => this.lay()); // windows change, and so do the lines above the stage
    watcher.observe(this.find(".stage"));
    this.ends.signal.addEventListener("abort", () => watcher.disconnect());
  }

  label(element, i) {
    const { text } = this.buttons[i];
    element.textContent = text;
    if (!text) element.ariaLabel = `${i + 1} of ${this.buttons.length}`;
    element.addEventListener("click", (event) => this.answer(i, event), { signal: this.ends.signal });
  }

  buildWalk(name, side) {
    const { task, contents } = this;
    const stimulus = contents.stimuli[name];
    const place = this.find(task.self_paced ? ".playable" : ".running").content.cloneNode(true).firstElementChild;
    const picture = document.createElement(stimulus.source === "movie" ? "video" : "canvas");
    const isMarked = task.mark_reference && name === this.row.reference;
    place.querySelector(".walk").prepend(picture);
    place.querySelector("figcaption").textContent = isMarked ? "original" : "";
    place.querySelector(".walk").ariaLabel = task.pair ? `${SIDES[side]}${isMarked ? ", the original" : ""}` : "Walk";
    this.find(".stage").append(place);
    const walk = this.makeWalk(picture, stimulus);
    Object.assign(walk, { name, count: 0, hasEnded: false, isPlaying: false, place: place.querySelector(".walk") });
    if (task.self_paced) walk.place.addEventListener("click", () => this.play(walk), { signal: this.ends.signal });
    return walk;
  }

  makeWalk(picture, stimulus) {
    const { task, row, contents, space } = this;
    if (stimulus.source === "movie") return new MovieWalk(picture, stimulus.file, task);
    const motion =
      stimulus.source === "harmonics"
        ? new HarmonicMotion(space, stimulus)
        : new FramedMotion(contents.motions[stimulus.motion], stimulus.displacement);
    return new CanvasWalk(picture, new Figure(motion, row.view), task);
  }

  /** Take the size of the screen; both walks of a pair are drawn to the same scale. */
  lay() {
    const eye = this.screen.eye;
    for (const walk of this.walks) walk.resize(eye);
    const scale = Math.min(...this.walks.map((walk) => walk.wantedScale));
    for (const walk of this.walks) walk.scale = scale;
    const isWhole = this.walks.every((walk) => walk.isWhole);
    this.find(".cramped").hidden = isWhole;
  }

  // What happens.

  /** Show the walks and wait for the answer; returns what is to be stored. */
  async run() {
    try {
      await Promise.all(this.walks.map((walk) => walk.ready));
      if (!this.task.self_paced) for (const walk of this.walks) this.play(walk);
      await this.answered;
      if (!this.task.self_paced) await Promise.all(this.running);
    } catch (error) {
      await this.askToGoOn(error);
    }
    this.ends.abort(); // what the participant has started goes on to here only
    await Promise.allSettled(this.running);
    return this.response;
  }

  play(walk) {
    if (walk.isPlaying || this.ends.signal.aborted) return;
    walk.isPlaying = true;
    walk.place.classList.add("playing");
    const playing = walk.play(this.screen.refresh, this.ends.signal, (play) => this.begin(walk, play));
    this.running.push(playing);
    playing.then((play) => this.end(walk, play), this.reject);
  }

  begin(walk, play) {
    walk.count += 1;
    this.plays.push(play);
    this.first ??= play.begin;
    this.allow();
  }

  end(walk, play) {
    walk.isPlaying = false;
    walk.hasEnded ||= play.isWhole;
    walk.place.classList.remove("playing");
    walk.place.classList.add("played");
    this.allow();
  }

  /** Answers are taken when all walks have begun, or come to their end, once. */
  allow() {
    const isAllowed = this.walks.every((walk) => (this.task.answer === "after" ? walk.hasEnded : walk.count > 0));
    if (isAllowed && !this.pressed) for (const element of this.elements) element.disabled = false;
  }

  answer(i, event) {
    if (this.pressed) return;
    this.pressed = { button: this.buttons[i], time: timeOf(event), at: new Date().toISOString() };
    this.elements.forEach((element, k) => {
      element.disabled = true;
      element.classList.toggle("pressed", k === i);
      element.ariaPressed = String(k === i);
    });
    this.resolve();
  }

  /** A walk cannot be shown: say so, and go on without an answer. */
  askToGoOn({ message }) {
    this.find(".note").textContent = `${message} Please tell the experimenter.`;
    const button = this.find(".skip");
    button.hidden = false;
    button.focus();
    return new Promise((resolve) => button.addEventListener("click", resolve, { once: true }));
  }

  /** Stop at once, without an answer. */
  stop() {
    this.ends.abort();
  }

  get response() {
    const { plays, pressed, screen } = this;
    const last = plays.at(-1);
    const total = (name) => plays.reduce((sum, play) => sum + play[name], 0);
    return {
      answer: pressed?.button.answer ?? "",
      value: pressed?.button.value ?? null,
      response_time_s: pressed && rounded((pressed.time - this.first) / SECOND),
      replays: this.walks.reduce((sum, { count }) => sum + Math.max(0, count - 1), 0),
      frames_drawn: total("drawn"),
      frames_dropped: total("dropped"),
      shown_s: last ? rounded(last.shown / SECOND) : null,
      shown_error_s: last?.isWhole ? rounded((last.shown - last.due) / SECOND) : null, // none where an answer cut it
      refresh_hz: rounded(SECOND / screen.refresh),
      pixels_per_degree: screen.pixelsPerDegree === null ? null : rounded(screen.pixelsPerDegree),
      pixel_ratio: devicePixelRatio,
      visit: screen.visit,
      answered_at: pressed?.at ?? new Date().toISOString(),
    };
  }
}
