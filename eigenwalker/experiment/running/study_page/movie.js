// A movie in place of a walk, from a file beside the page.
import { Play, showFrames } from "./timing.js";

export class MovieWalk {
  constructor(video, file, task) {
    Object.assign(this, { video, file, task, isWhole: true });
    Object.assign(video, { muted: true, playsInline: true, preload: "auto" });
    this.ready = new Promise((resolve, reject) => {
      video.addEventListener("canplaythrough", resolve, { once: true });
      video.addEventListener("error", () => reject(new Error(`The movie ${file} cannot be played.`)), { once: true });
    });
    video.src = file.split("/").map(encodeURIComponent).join("/");
    this.clear();
  }

  get duration() {
    return 1000 * (this.task.duration ?? this.video.duration);
  }

  /** A movie has the size that it was made in, or less. */
  resize() {}

  get wantedScale() {
    return 1;
  }

  set scale(scale) {}

  async play(refresh, signal, onBegin) {
    const { video } = this;
    const play = new Play(refresh, this.duration);
    video.currentTime = 0;
    const before = this.counts;
    await video.play();
    video.style.visibility = "visible";
    await showFrames(play, { draw: () => {}, clear: () => this.clear(), signal, onBegin });
    const after = this.counts;
    play.drawn = after.drawn - before.drawn; // frames of the movie, not refreshes of the screen
    play.dropped = after.dropped - before.dropped;
    return play;
  }

  get counts() {
    const { totalVideoFrames: all, droppedVideoFrames: dropped } = this.video.getVideoPlaybackQuality();
    return { drawn: all - dropped, dropped };
  }

  clear() {
    this.video.pause();
    this.video.style.visibility = "hidden";
  }
}
