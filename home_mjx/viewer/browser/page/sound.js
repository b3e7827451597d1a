// Live sound: a WebSocket fills the ring buffer of an AudioWorklet; a click starts it, another mutes it.

const FLOOR = -60;  // [dB] lowest level of the meter
const MIN_FREQUENCY = 60;  // [Hz] of the spectrogram's lowest row; the highest has half the sample rate

// Bin of a row of the spectrogram, from the bottom; frequencies are logarithmic.
export function frequencyBin(row, rows, bins, rate) {
  const frequency = MIN_FREQUENCY * (rate / 2 / MIN_FREQUENCY) ** (row / (rows - 1));
  return Math.min(bins - 1, Math.round(frequency / (rate / 2) * bins));
}

export class Sound {
  constructor({ url, button, gain, meter, spectrum, state }) {
    Object.assign(this, { url, button, gain, meter: meter.getContext("2d"), spectrum: spectrum.getContext("2d"), state,
      stats: null, isOn: false, agent: 0 });
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
    this.socket.onopen = () => this.listen(this.agent);
    this.socket.onmessage = ({ data }) => this.receive(data);
    this.socket.onclose = () => this.isOn && setTimeout(() => this.isOn && this.restart(), 1000);
  }

  listen(agent) {  // at the ears of this agent
    this.agent = agent;
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ type: "listen", agent }));
  }

  restart() { this.stop(); this.start(); }

  stop() {
    this.isOn = false;
    this.socket?.close();
    this.context?.close();
    this.socket = this.context = this.node = this.analyser = null;
    this.spectrum.clearRect(0, 0, this.spectrum.canvas.width, this.spectrum.canvas.height);
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
    this.analyser = context.createAnalyser();
    Object.assign(this.analyser, { fftSize: 1024, smoothingTimeConstant: 0, minDecibels: -100, maxDecibels: -20 });
    this.node.connect(this.analyser);
    this.node.connect(this.volume).connect(context.destination);
    requestAnimationFrame(() => this.drawSpectrum());
    await context.resume();
  }

  // One more column of the spectrogram, of the mean of both ears before the gain; lowest frequency at the bottom.
  drawSpectrum() {
    if (!this.isOn || !this.analyser) return;
    const { width, height } = this.spectrum.canvas;
    const bins = new Uint8Array(this.analyser.frequencyBinCount);
    this.analyser.getByteFrequencyData(bins);
    this.spectrum.drawImage(this.spectrum.canvas, -1, 0);
    for (let row = 0; row < height; row++) {
      const level = bins[frequencyBin(height - 1 - row, height, bins.length, this.context.sampleRate)] / 255;
      this.spectrum.fillStyle = `hsl(${280 - 240 * level} 90% ${60 * level}%)`;
      this.spectrum.fillRect(width - 1, row, 1, 1);
    }
    requestAnimationFrame(() => this.drawSpectrum());
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
