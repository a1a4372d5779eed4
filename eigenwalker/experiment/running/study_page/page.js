// A page of its own, or a component of a JATOS study.
import { JatosRun } from "./jatos_run.js";
import { Study } from "./study.js";

const contents = JSON.parse(document.querySelector("#contents").textContent);
const root = document.querySelector(".study");
const server = globalThis.jatos;
if (server) server.onLoad(() => new Study(root, contents, new JatosRun(server, contents)).run());
else new Study(root, contents).run();
