// When something is on the screen. Frames come with the time of their refresh, in milliseconds.

const REFRESHES = 20; // measured before the first trial
const SETTLING = 4; // refreshes that a page needs to come to rest

/** The time of the next refresh. */
export const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));

/** Milliseconds from one refresh of the screen to the next: the mean of some that are no longer than most. */
export async function measureRefresh() {
  const times = [];
  while (times.length <= SETTLING + REFRESHES) times.push(await nextFrame());
  const gaps = times.slice(SETTLING + 1).map((time, i) => time - times[SETTLING + i]);
  const usual = [...gaps].sort((one, other) => one - other)[Math.floor(REFRESHES / 2)];
  const kept = gaps.filter((gap) => gap < 1.5 * usual && gap > 0.5 * usual);
  return kept.reduce((sum, gap) => sum + gap, 0) / kept.length; // browsers round single times
}

/** When an event happened, on the clock of the frames. */
export function timeOf(event) {
  const now = performance.now();
  return Math.abs(now - event.timeStamp) < 1000 ? event.timeStamp : now; // some browsers count from another origin
}

/** One play of a walk: when it began, how many frames were drawn, and for how many refreshes none came. */
export class Play {
  constructor(refresh, due) {
    Object.assign(this, { refresh, due, begin: null, last: null, drawn: 0, dropped: 0, shown: 0, isWhole: false });
  }

  /** A frame is on the screen from now on. */
  frame(now) {
    if (this.begin === null) this.begin = now;
    else this.pass(now);
    this.drawn += 1;
  }

  /** The last frame is gone, because its time has come or because an answer cut it short. */
  end(now, isWhole) {
    if (this.begin === null) return;
    this.pass(now);
    this.shown = now - this.begin;
    this.isWhole = isWhole;
  }

  pass(now) {
    const gap = (now - (this.last ?? this.begin)) / this.refresh;
    if (gap > 1.5) this.dropped += Math.round(gap) - 1;
    this.last = now;
  }

  /** Whether what is due ends with a frame at this time rather than with the one after it. */
  isOver(now) {
    return this.begin !== null && now - this.begin >= this.due - this.refresh / 2;
  }
}

/**
 * Draw a frame with every refresh from the next one on, and clear them with the refresh that is nearest to when they
 * are due to end. `draw` is told the milliseconds since the first frame; `onBegin` is called after that one.
 */
export function showFrames(play, { draw, clear, signal, onBegin }) {
  return new Promise((resolve) => {
    const finish = (now, isWhole) => {
      clear();
      play.end(now, isWhole);
      resolve(play);
    };
    const tick = (now) => {
      if (signal.aborted) return;
      if (play.isOver(now)) {
        signal.removeEventListener("abort", cut);
        finish(now, true);
        return;
      }
      play.frame(now);
      draw(now - play.begin);
      if (play.drawn === 1) onBegin(play);
      requestAnimationFrame(tick);
    };
    const cut = () => finish(performance.now(), false);
    signal.addEventListener("abort", cut, { once: true });
    requestAnimationFrame(tick);
  });
}
