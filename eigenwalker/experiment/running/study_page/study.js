// A study from its first screen to its last.
import { csvTable, saveFile } from "./answers.js";
import { askSize, Calibration } from "./calibration.js";
import { countAnswers, Journal } from "./journal.js";
import { clicked, Screens } from "./screens.js";
import { makeTimeline, rowsOf } from "./timeline.js";
import { measureRefresh } from "./timing.js";
import { Trial } from "./trial.js";
import { WalkerSpace } from "./walker.js";

const FULL =
  "This browser has no room to store answers. They are kept in this window only: download them, again at the end of " +
  "the study, and do not close the window before.";
const SCARCE = "This browser has little room for answers. If there is none left, this window will say so.";
const OFFLINE = "The server cannot be reached. Your answers are kept here and sent when it is back.";

export class Study {
  /** `server` takes the answers of a study that runs in JATOS; else null. */
  constructor(root, contents, server = null) {
    Object.assign(this, { root, contents, server, journal: null, trial: null, refresh: null });
    root.study = this;
    this.path = server?.path ?? [contents.study];
    this.screens = new Screens(root, () => this.save());
    this.space = contents.space && new WalkerSpace(contents.space);
    this.responses = contents.columns.filter((name) => name !== "study" && !(name in contents.design));
    this.calibration = new Calibration(contents.study);
    addEventListener("beforeunload", (event) => this.hold(event));
    for (const kind of ["error", "unhandledrejection"]) addEventListener(kind, (event) => this.fail(event));
  }

  async run() {
    const participant = await this.welcome();
    this.openJournal(participant);
    this.journal.open(() => this.stop());
    if (this.server) await this.resume();
    if (!this.journal.hasRoom && !this.server) this.screens.warn(SCARCE, { canDownload: false });
    await this.prepare();
    if (!this.isDone) await this.runTrials();
    if (!this.isStopped) await this.end();
  }

  // Before the trials.

  /** Which participant: from the server, the address, or the participant. */
  async welcome() {
    const { n_participants: count, title } = this.contents;
    const asked = this.server
      ? await this.server.takeParticipant()
      : Number(new URL(location).searchParams.get("participant"));
    const isKnown = Number.isInteger(asked) && asked >= 1 && asked <= count;
    const counts = countAnswers(this.path);
    const taken = await this.screens.welcome({
      title,
      count,
      given: isKnown ? asked : null,
      problem: this.problemOf(asked, isKnown),
      progress: (number) => number && [counts.get(number) ?? 0, rowsOf(this.contents, number).length],
      choose: (number) => number && this.openJournal(number),
    });
    if (this.server && !isKnown) await this.server.keepParticipant(taken);
    return taken;
  }

  problemOf(asked, isKnown) {
    if (isKnown) return "";
    if (this.server) return "No number is free any more. Please ask the experimenter for yours.";
    return asked ? `There is no participant ${asked} in this study.` : "";
  }

  openJournal(participant) {
    this.journal?.close();
    this.journal = new Journal(this.path, participant, rowsOf(this.contents, participant), this.responses);
  }

  /** Rows that the server has are done, wherever they were answered; what it has not got yet is sent again. */
  async resume() {
    const { journal, server } = this;
    const { sent, visits = 0 } = server.session;
    journal.visit = visits + 1;
    this.isSent = (row) => journal.rows.indexOf(row) < sent;
    await server.remember({ visits: journal.visit }).catch(() => {});
    for (const row of journal.rows) if (journal.has(row) && !this.isSent(row)) this.send(row);
  }

  async prepare() {
    const { journal, contents, screens } = this;
    if (this.isDone) return;
    if (contents.consent && !journal.consent && !this.server?.session.consent) {
      journal.consent = await screens.consent(contents.title, contents.consent);
      await this.server?.remember({ consent: new Date().toISOString() }).catch(() => {});
    }
    if (contents.calibrate) {
      screens.show("calibration");
      await askSize(screens.element, this.calibration, contents.viewing_distance);
    }
    this.refresh = await screens.ready(measureRefresh);
    screens.clear();
  }

  // Trials.

  isAnswered(row) {
    return this.journal.has(row) || Boolean(this.isSent?.(row));
  }

  get isDone() {
    return this.journal.rows.every((row) => this.isAnswered(row));
  }

  async runTrials() {
    const room = this.root.querySelector(".room");
    this.jsPsych = initJsPsych({
      display_element: room,
      on_trial_start: () => (room.tabIndex = -1), // the tab key has no stop at the whole page
      override_safe_mode: true, // which is about files that are fetched, and here none are
      use_webaudio: false,
    });
    const timeline = makeTimeline(this.contents, this.journal.rows, {
      isAnswered: (row) => this.isAnswered(row),
      runTrial: (element, row, task) => this.runTrial(element, row, task),
      save: () => this.save(),
    });
    await this.jsPsych.run(timeline);
    room.remove();
  }

  async runTrial(element, row, task) {
    const { contents, space } = this;
    this.trial = new Trial(element, { row, task, contents, space, screen: this });
    const response = await this.trial.run();
    if (this.isStopped) return;
    const kept = this.journal.keep(row, response);
    if (kept === "elsewhere") {
      this.stop();
      return;
    }
    if (this.server) this.send(row);
    else this.screens.warn(kept === "memory" ? FULL : "");
    this.jsPsych.finishTrial({});
  }

  /** What trials must know of the screen. */
  get eye() {
    return this.contents.calibrate ? this.calibration.eye : null;
  }

  get pixelsPerDegree() {
    return this.contents.calibrate ? this.calibration.pixelsPerDegree : null;
  }

  get visit() {
    return this.journal.visit;
  }

  async send(row) {
    const { journal, server } = this;
    const isIn = await server.send(journal.rows.indexOf(row), this.table([row])[0]);
    if (isIn) for (const one of journal.rows) journal.release(one);
    this.screens.warn(isIn ? "" : OFFLINE, { canDownload: journal.unsaved.size > 0 });
    return isIn;
  }

  // Answers.

  /** Answers with all columns. */
  table(rows = this.journal.rows) {
    const wanted = new Set(rows);
    const answered = this.journal.rows.filter((row) => wanted.has(row) && this.journal.has(row));
    return answered.map((row) => ({ study: this.contents.study, ...row, ...this.journal.answerTo(row) }));
  }

  save() {
    const { study, columns } = this.contents;
    const name = `study-${study}_participant-${this.journal.participant}_data.csv`;
    saveFile(csvTable(this.table(), columns), name.replace(/[^\w.-]/g, "-"));
  }

  // How it comes to an end.

  async end() {
    if (document.fullscreenElement) await document.exitFullscreen().catch(() => {});
    if (this.server) {
      await this.endOnServer();
      return;
    }
    const count = this.journal.rows.length;
    this.journal.rescue();
    const where = this.journal.unsaved.size ? "are kept in this window only" : "are stored in this browser";
    this.screens.end(`You have answered all ${count}. Your answers ${where}.`);
  }

  async endOnServer() {
    const find = this.screens.show("sent");
    const words = find(".words");
    words.textContent = "Sending the last answers …";
    while (!(await this.server.flush())) {
      words.textContent =
        "Not all of your answers could be sent. Try again, or download them and give them to the experimenter.";
      for (const button of [find(".go"), find(".download")]) button.hidden = false;
      await clicked(find(".go"));
      words.textContent = "Sending the last answers …";
    }
    this.screens.warn("");
    words.textContent = "All of your answers have been sent. You can close this window.";
    this.journal.clear();
    this.server.finish();
  }

  /** Let nobody leave with answers that are nowhere else. */
  hold(event) {
    if (!this.journal?.unsaved.size) return;
    event.preventDefault();
    event.returnValue = true; // for browsers of 2023 and before
  }

  /** Another window of this participant goes on. */
  stop() {
    if (this.isStopped) return;
    this.isStopped = true;
    this.trial?.stop();
    this.journal.close();
    this.jsPsych?.abortExperiment();
    this.root.querySelector(".room")?.remove();
    if (this.journal.unsaved.size === 0) this.screens.warn("");
    const find = this.screens.show("taken");
    find(".go").addEventListener("click", () => location.reload());
  }

  fail(event) {
    const { message } = event.reason ?? event.error ?? event;
    this.screens.warn(`Something went wrong: ${message}. Please tell the experimenter, and reload the page to go on.`);
  }
}
