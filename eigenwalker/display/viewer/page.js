// A page of its own: what it is told is in the page, what is changed is in its address.
import { openViewer } from "./viewer.js";

const contents = JSON.parse(document.querySelector("#contents").textContent);
const viewer = openViewer(document.querySelector(".eigenwalker"), contents, { link: location.protocol !== "about:" });
viewer.follow(location.hash);
addEventListener("hashchange", () => viewer.follow(location.hash));
