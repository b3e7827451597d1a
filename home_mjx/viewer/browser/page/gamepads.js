// Gamepads of the standard layout: sticks are components of actions, buttons are keys of the page's own socket.

const DEAD = 0.15;  // tilt of a stick that counts as none
const PERIOD = 33;  // [ms], between polls
const AXES = ["left", "forward", "turn_left", "look_up"];  // of both sticks, each positive to the left or up
const BUTTONS = { 0: "p", 1: "o", 2: "e", 3: "c", 5: "t", 9: " " };  // A, B, X, Y, right shoulder, start

// Tilts by component, each in steps of 0.05; none within the dead zone.
export function readAxes(axes) {
  const known = AXES.map((name, n) => [name, -(axes[n] ?? 0)]).filter(([, tilt]) => Math.abs(tilt) > DEAD);
  return Object.fromEntries(known.map(([name, tilt]) => [name, Math.max(-1, Math.min(1, Math.round(20 * tilt) / 20))]));
}

export class Gamepads {
  // `send` returns whether a message was sent; others are sent again at the next poll.
  constructor(send) {
    Object.assign(this, { send, axes: "{}", pressed: new Set() });
    setInterval(() => this.poll(), PERIOD);
  }

  poll() {
    if (!document.hasFocus()) return this.forget();
    const pad = [...(navigator.getGamepads?.() ?? [])].find((found) => found?.connected);
    const values = readAxes(pad?.axes ?? []), axes = JSON.stringify(values);
    if (axes !== this.axes && this.send({ type: "axes", values })) this.axes = axes;
    for (const [number, key] of Object.entries(BUTTONS)) {
      const isDown = Boolean(pad?.buttons[number]?.pressed);
      if (isDown === this.pressed.has(key) || !this.send({ type: isDown ? "keydown" : "keyup", key })) continue;
      if (isDown) this.pressed.add(key); else this.pressed.delete(key);
    }
  }

  // Nothing is held any more, as after `release`: what still is, is sent at the next poll.
  forget() {
    this.axes = "{}";
    this.pressed.clear();
  }
}
