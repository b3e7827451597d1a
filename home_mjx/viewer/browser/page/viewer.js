// Page around viser's scene: the simulator's own picture, keys of a human agent, and sound.
import { Gamepads } from "./gamepads.js";
import { Sound } from "./sound.js";

const $ = (id) => document.getElementById(id);
const socketUrl = (path) => new URL(path, location.href).href.replace(/^http/, "ws");
const picture = $("picture").getContext("2d");
const grid = $("tiles").getContext("2d");
const frames = [];
let tiles = { numbers: [], columns: 1, watched: 0 };
let live = null;
let drives = false;
let agents = 1;
let seat = null;  // agent that this page drives
window.viewer = { frames: 0, grids: 0, sound: null };  // figures for tests and bug reports

function connect() {
  live = new WebSocket(socketUrl("live"));
  live.binaryType = "arraybuffer";
  live.onopen = () => { if (!$("scene").src) $("scene").src = "scene/"; };
  live.onmessage = ({ data }) => {
    if (typeof data === "string") showState(JSON.parse(data));
    else if (new Uint8Array(data, 0, 1)[0] === 1) showTiles(data.slice(1));  // the server's TILE_MARK
    else showFrame(data);
  };
  live.onclose = () => {
    takeSeat(null);  // the server has freed it
    $("status").textContent = "connection lost; trying again"; setTimeout(connect, 1000); };
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
    ? `${(1000 * (frames.length - 1) / Math.max(now - frames[0], 500)).toFixed(0)} frames/s` : "";
}

async function showTiles(data) {
  $("grid").hidden = false;
  const image = await createImageBitmap(new Blob([data], { type: "image/jpeg" }));
  const { canvas } = grid;
  canvas.width = image.width;
  canvas.height = image.height;
  grid.drawImage(image, 0, 0);
  image.close();
  const side = canvas.width / tiles.columns, at = tiles.numbers.indexOf(tiles.watched);
  grid.font = "14px system-ui";
  grid.lineWidth = 4;
  grid.strokeStyle = "#e0a458";
  tiles.numbers.forEach((number, n) => {
    const x = (n % tiles.columns) * side, y = Math.floor(n / tiles.columns) * side;
    grid.fillStyle = "#000a";
    grid.fillRect(x + 3, y + 3, 12 + 8 * String(number).length, 20);
    grid.fillStyle = "#fff";
    grid.fillText(number, x + 9, y + 18);
    if (n === at) grid.strokeRect(x + 2, y + 2, side - 4, side - 4);
  });
  window.viewer.grids += 1;
}

function watchTile(event) {
  const { canvas } = grid, side = canvas.clientWidth / tiles.columns;
  const n = Math.floor(event.offsetY / side) * tiles.columns + Math.floor(event.offsetX / side);
  if (n in tiles.numbers) send({ type: "watch", number: tiles.numbers[n] });
}

function showState(state) {
  if ("tiles" in state) tiles = state.tiles;
  for (const id of ["instruction", "status", "caption", "keys"]) if (id in state) $(id).textContent = state[id];
  if ("drives" in state) drives = state.drives;
  if ("agents" in state) agents = state.agents;
  if ("notice" in state) $("notice").textContent = state.notice;
  if ("drives" in state || "agents" in state) showSeats();
  if ("seat" in state) takeSeat(state.seat);
  if ("sound" in state) sound.setAvailable(state.sound);
}

function showSeats() {
  const names = ["not driving", ...Array.from({ length: agents }, (_, n) => `drive agent ${n + 1}`)];
  $("seat").replaceChildren(...names.map((name, n) => new Option(name, n - 1)));
  $("seat").hidden = !drives;
  takeSeat(seat);
}

function takeSeat(agent) {
  seat = agent;
  $("seat").value = seat ?? -1;
  sound.listen(seat ?? 0);
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
function send(message) {  // returns whether the connection is open
  if (live?.readyState !== WebSocket.OPEN) return false;
  live.send(JSON.stringify(message));
  return true;
}
function release() {
  send({ type: "release" });
  window.viewer.gamepads.forget();
}
function listen(target) {
  for (const type of ["keydown", "keyup"]) target.addEventListener(type, onKey, { capture: true });
  target.addEventListener("blur", release);
}

const sound = new Sound({ url: socketUrl("sound"), button: $("sound"), gain: $("gain"), meter: $("meter"), spectrum: $("spectrum"),
  state: $("sound-state") });
window.viewer.sound = sound;
window.viewer.gamepads = new Gamepads((message) => drives && send(message));
$("seat").addEventListener("change", () => {
  const agent = Number($("seat").value);
  $("notice").textContent = "";
  send({ type: "drive", agent: agent < 0 ? null : agent });
  $("seat").blur();
});
$("tiles").addEventListener("click", watchTile);
listen(window);
$("scene").addEventListener("load", () => listen($("scene").contentWindow));
connect();
