// The answers of one participant: each is stored when its trial ends, under a key of its own, and never written again.
import { Shelf } from "./storage.js";

const ROOM = 256; // letters that an answer takes at most, with its key
const [FILLER, OWNER, VISITS, CONSENT] = ["room", "owner", "visits", "consent"];
const ANSWER = /^\d+\/\d+$/;

const nameOf = ({ session, trial }) => `${session}/${trial}`;

/** How many answers of each participant are stored, as a Map. */
export function countAnswers(path) {
  const counts = new Map();
  for (const name of new Shelf(...path).names) {
    const [participant, ...rest] = name.split("/");
    if (ANSWER.test(rest.join("/"))) counts.set(Number(participant), (counts.get(Number(participant)) ?? 0) + 1);
  }
  return counts;
}

export class Journal {
  /** `rows` are those of the participant, in order; `columns` the names of what is answered. */
  constructor(path, participant, rows, columns) {
    Object.assign(this, { participant, rows, columns, answers: new Map(), unsaved: new Set() });
    this.shelf = new Shelf(...path, participant);
    this.ends = new AbortController();
    for (const row of rows) {
      const stored = this.read(nameOf(row));
      if (stored) this.answers.set(nameOf(row), Object.fromEntries(columns.map((name, i) => [name, stored[i]])));
    }
  }

  /** What is stored of an answer, or null; what is no answer does not count. */
  read(name) {
    const stored = this.shelf.getJson(name);
    return Array.isArray(stored) ? stored : null;
  }

  /** Become the one window that this participant answers in, and hear when another one does. */
  open(onTaken) {
    this.window = `${Date.now()}-${Math.random()}`;
    this.visit = 1 + (this.shelf.getJson(VISITS) ?? 0);
    this.shelf.remove(FILLER);
    this.shelf.putJson(VISITS, this.visit);
    this.shelf.remove(OWNER); // where there is no room for another name, there is none for the old one either
    this.shelf.put(OWNER, this.window);
    this.shelf.watch(OWNER, () => this.isTaken && onTaken(), this.ends.signal);
    this.hasRoom = this.reserve();
  }

  get isTaken() {
    const owner = this.shelf.get(OWNER);
    return owner !== null && owner !== this.window;
  }

  /** Hold the room that answers to come will need; it is given back as they come. */
  reserve() {
    const count = this.rows.length - this.answers.size;
    if (count > 0) return this.shelf.put(FILLER, "-".repeat(ROOM * count));
    this.shelf.remove(FILLER);
    return true;
  }

  /** Store something, in the room that is held if there is no other. */
  write(name, text) {
    const isStored = this.shelf.put(name, text) || (this.shelf.remove(FILLER), this.shelf.put(name, text));
    this.reserve();
    return isStored;
  }

  has(row) {
    return this.answers.has(nameOf(row));
  }

  answerTo(row) {
    return this.answers.get(nameOf(row));
  }

  /**
   * Keep an answer, and say where it is: "stored", "memory" where the browser has no room, or "elsewhere" where another
   * window has taken over or has an answer to this trial already.
   */
  keep(row, answer) {
    const name = nameOf(row);
    if (this.isTaken || this.read(name)) return "elsewhere";
    this.answers.set(name, answer);
    this.unsaved.add(name);
    this.rescue();
    return this.unsaved.size > 0 ? "memory" : "stored";
  }

  /** Store what is in memory only, as far as there is room. */
  rescue() {
    for (const name of this.unsaved) {
      const values = this.columns.map((column) => this.answers.get(name)[column]);
      if (this.write(name, JSON.stringify(values))) this.unsaved.delete(name);
    }
  }

  /** An answer is safe with someone else. */
  release(row) {
    this.unsaved.delete(nameOf(row));
  }

  get consent() {
    return this.shelf.get(CONSENT);
  }

  set consent(time) {
    this.write(CONSENT, time);
  }

  close() {
    this.ends.abort();
  }

  /** Leave nothing behind. */
  clear() {
    for (const name of this.shelf.names) this.shelf.remove(name);
  }
}
