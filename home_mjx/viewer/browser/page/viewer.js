// Page around viser's scene: the simulator's own picture, keys of a human agent, and sound.
import { Sound } from "./sound.js";

const $ = (id) => document.getElementById(id);
const socketUrl = (path) => new URL(path, location.href).href.replace(/^http/, "ws");
const picture = $("picture").getContext("2d");
const frames = [];
let live = null;
let drives = false;
window.viewer = { frames: 0, sound: null };  // figures for tests and bug reports

function connect() {
  live = new WebSocket(socketUrl("live"));
  live.binaryType = "arraybuffer";
  live.onopen = () => { if (!$("scene").src) $("scene").src = "scene/"; };
  live.onmessage = ({ data }) => typeof data === "string" ? showState(JSON.parse(data)) : showFrame(data);
  live.onclose = () => { $("status").textContent = "connection lost; trying again"; setTimeout(connect, 1000); };
}

async function showFrame(data) {
  const image = await createImageBitmap(new Blob([data], { type: "image/jpeg" }));
  picture.canvas.width = image.width;
  picture.canvas.height = image.height;
  picture.drawImage(image, 0, 0);
  image.close();
  const now = performance.now();
  frames.push(now);
  while (frames[0] < now - 2000) frames.shift();
  window.viewer.frames += 1;
  $("rate").textContent = frames.length > 2
    ? `${(1000 * (frames.length - 1) / (now - frames[0])).toFixed(0)} frames/s` : "";
}

function showState(state) {
  for (const id of ["instruction", "status", "caption", "keys"]) if (id in state) $(id).textContent = state[id];
  if ("drives" in state) drives = state.drives;
  if ("sound" in state) sound.setAvailable(state.sound);
}

// Keys go to the agent while a human drives it, wherever the focus is; else viser moves its camera by them.
const isTyping = (target) => /^(INPUT|TEXTAREA|SELECT)$/.test(target?.tagName ?? "") && target.type !== "range";
function onKey(event) {
  if (!drives || isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
  const key = { ArrowUp: "w", ArrowDown: "s", ArrowLeft: "a", ArrowRight: "d" }[event.key] ?? event.key;
  if (key.length !== 1) return;
  event.stopPropagation();
  event.preventDefault();
  if (!event.repeat) send({ type: event.type, key: key.toLowerCase() });
}
function send(message) { if (live?.readyState === WebSocket.OPEN) live.send(JSON.stringify(message)); }
function listen(target) {
  for (const type of ["keydown", "keyup"]) target.addEventListener(type, onKey, { capture: true });
  target.addEventListener("blur", () => send({ type: "release" }));
}

const sound = new Sound({ url: socketUrl("sound"), button: $("sound"), gain: $("gain"), meter: $("meter"),
  state: $("sound-state") });
window.viewer.sound = sound;
listen(window);
$("scene").addEventListener("load", () => listen($("scene").contentWindow));
connect();
