// Live sound: a WebSocket fills the ring buffer of an AudioWorklet; a click starts it, another mutes it.

const FLOOR = -60;  // [dB] lowest level of the meter

export class Sound {
  constructor({ url, button, gain, meter, state }) {
    Object.assign(this, { url, button, gain, meter: meter.getContext("2d"), state, stats: null, isOn: false });
    button.addEventListener("click", () => (this.isOn ? this.stop() : this.start()));
    gain.addEventListener("input", () => this.setGain());
    this.setAvailable(false);
  }

  setAvailable(isAvailable) {
    this.button.disabled = !isAvailable;
    if (!isAvailable) this.stop();
    this.state.textContent = isAvailable ? "" : "this environment has no sound";
  }

  async start() {
    if (!window.isSecureContext || !window.AudioWorkletNode) {
      this.state.textContent = "browsers allow sound on localhost or https only: open the page through an SSH tunnel";
      return;
    }
    this.isOn = true;
    this.button.textContent = "Sound: on";
    this.button.classList.add("on");
    this.socket = new WebSocket(this.url);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = ({ data }) => this.receive(data);
    this.socket.onclose = () => this.isOn && setTimeout(() => this.isOn && this.restart(), 1000);
  }

  restart() { this.stop(); this.start(); }

  stop() {
    this.isOn = false;
    this.socket?.close();
    this.context?.close();
    this.socket = this.context = this.node = null;
    this.button.textContent = "Sound: muted";
    this.button.classList.remove("on");
    this.meter.clearRect(0, 0, this.meter.canvas.width, this.meter.canvas.height);
  }

  async receive(data) {
    if (typeof data === "string") return this.open(JSON.parse(data));
    const samples = new Float32Array(data);
    this.node?.port.postMessage(samples, [samples.buffer]);
  }

  // The first message has the sample rate: the context runs at it, so that the browser resamples to its device.
  async open({ rate, delay }) {
    const context = this.context = new AudioContext({ sampleRate: rate });
    await context.audioWorklet.addModule("worklet.js");
    if (this.context !== context) return;
    this.node = new AudioWorkletNode(context, "ring", { numberOfInputs: 0, outputChannelCount: [2],
      processorOptions: { delay } });
    this.node.port.onmessage = ({ data }) => this.show(data);
    this.volume = context.createGain();
    this.setGain();
    this.node.connect(this.volume).connect(context.destination);
    await context.resume();
  }

  setGain() { if (this.volume) this.volume.gain.value = 10 ** (this.gain.value / 20); }

  show(stats) {
    this.stats = stats;
    const { width, height } = this.meter.canvas;
    this.meter.clearRect(0, 0, width, height);
    stats.level.forEach((rms, ear) => {
      const level = 20 * Math.log10(Math.max(rms, 1e-9)) + Number(this.gain.value);
      this.meter.fillStyle = level > -1 ? "#d9534f" : "#4caf72";
      this.meter.fillRect(2, 2 + ear * height / 2, (width - 4) * Math.min(1, Math.max(0, 1 - level / FLOOR)), height / 2 - 3);
    });
    this.state.textContent = `${(1000 * stats.delay).toFixed(0)} ms${stats.gaps ? `, ${stats.gaps} gaps` : ""}`;
  }
}
