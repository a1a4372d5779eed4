// A study that runs in JATOS: who takes part, what is left to do, and where answers go.

const NAME = "eigenwalker"; // of what is ours in the study session
const ATTEMPTS = 20;
const WAIT = 250; // milliseconds, and up to as much again at random, so that two who collide part

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

export class JatosRun {
  constructor(jatos, contents) {
    Object.assign(this, { jatos, contents, queue: [], sending: null });
    this.path = [contents.study, String(jatos.studyResultId)]; // every run keeps its own answers in the browser
  }

  /** What is known of this run, also after a reload: participant, visit, and how many rows have come in. */
  get session() {
    return { sent: 0, ...this.jatos.studySessionData?.[NAME] };
  }

  async remember(changes) {
    const session = { ...this.session, ...changes };
    await this.jatos.setStudySessionData({ ...this.jatos.studySessionData, [NAME]: session });
  }

  /** The number that this run has, that its address gives, or the next one of its batch; null where there is none. */
  async takeParticipant() {
    const { participant } = this.session;
    if (participant) return participant;
    const given = Number(this.jatos.urlQueryParameters?.participant);
    const isGiven = Number.isInteger(given) && given >= 1 && given <= this.contents.n_participants;
    const taken = isGiven ? given : await this.claim();
    if (taken) await this.keepParticipant(taken);
    return taken;
  }

  /** Hold to a participant, and let no other run of the batch take the number. */
  async keepParticipant(participant) {
    try {
      await this.remember({ participant });
      if (this.holderOf(participant) === null) await this.take(participant);
    } catch {
      // without a batch session numbers are given out by hand
    }
  }

  placeOf(participant) {
    return `/${this.contents.study}_${participant}`;
  }

  /** The run that has taken a number, or null. */
  holderOf(participant) {
    const { batchSession } = this.jatos;
    const place = this.placeOf(participant);
    return batchSession.defined(place) ? batchSession.find(place) : null;
  }

  take(participant) {
    return this.jatos.batchSession.add(this.placeOf(participant), String(this.jatos.studyResultId));
  }

  /**
   * Take the first free number, or that which this run took just before it was reloaded. JATOS refuses what is added to
   * a batch session that another run has just changed, so that no two runs have the same number; then this one tries
   * again.
   */
  async claim() {
    const run = String(this.jatos.studyResultId);
    const numbers = Array.from({ length: this.contents.n_participants }, (_, i) => i + 1);
    for (let attempt = 0; attempt < ATTEMPTS; attempt++) {
      try {
        const own = numbers.find((number) => this.holderOf(number) === run);
        if (own) return own;
        const free = numbers.find((number) => this.holderOf(number) === null);
        if (!free) return null;
        await this.take(free);
        return free;
      } catch {
        await pause(WAIT * (1 + Math.random()));
      }
    }
    return null;
  }

  /** Send an answer; `number` is that of its row, from 0. Resolves to whether it, and all before it, have come in. */
  send(number, answer) {
    this.queue.push({ number, line: `${JSON.stringify(answer)}\n` });
    return this.flush();
  }

  flush() {
    this.sending ??= this.sendAll().finally(() => (this.sending = null));
    return this.sending;
  }

  async sendAll() {
    while (this.queue.length > 0) {
      const lines = [...this.queue];
      try {
        await this.jatos.appendResultData(lines.map(({ line }) => line).join(""));
        this.queue.splice(0, lines.length);
        await this.remember({ sent: Math.max(this.session.sent, lines.at(-1).number + 1) });
      } catch {
        return this.queue.length === 0;
      }
    }
    return true;
  }

  finish() {
    this.jatos.endStudy();
  }
}
